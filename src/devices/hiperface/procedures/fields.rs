//! Reads data fields (commands 4Ch and 4Ah). A long transfer that the line damages is split in half.

use super::error::ReplyDamage;
use super::identify::read_type_label;
use super::master::ExchangeFailure;
use super::{Error, Master};
use crate::devices::hiperface::profile::FieldImage;
use crate::devices::hiperface::protocol::{
    AccessCode, Command, DataFieldStatus, MAX_TRANSFER, Reply, Request, StatusCode,
};

/// Minimum number of bytes per transfer. A shorter frame would consist mostly of its header.
const MIN_TRANSFER: usize = 4;

/// Reads the status byte of a field.
///
/// # Errors
/// Returns an error if the field does not exist or the exchange fails.
pub fn read_field_status(master: &mut Master<'_>, field: u8) -> Result<DataFieldStatus, Error> {
    match master.request_confirmed(&Request::FieldStatus { field })? {
        Reply::FieldStatus(status) => Ok(status),
        other => Err(Error::unexpected_reply(Command::FieldStatus, &other)),
    }
}

/// Reads a complete field. The returned field has no bytes if the access code is wrong.
///
/// # Errors
/// Returns an error if the encoder rejects the request for another reason or the exchange fails.
pub fn read_field(master: &mut Master<'_>, number: u8) -> Result<FieldImage, Error> {
    let status = read_field_status(master, number)?;
    let code = master.station().codes.get(status.code());
    match read_range(master, number, 0, status.size().bytes(), code) {
        Ok(bytes) => Ok(FieldImage { number, status, bytes: Some(bytes) }),
        Err(error) if error.is_rejection(StatusCode::WRONG_CODE) => Ok(FieldImage { number, status, bytes: None }),
        Err(error) => Err(error),
    }
}

/// Reads all fields except the extended label. `progress` receives the number of fields read and the total.
///
/// # Errors
/// Returns an error from [`read_field`] if a field cannot be read.
pub fn read_all_fields(
    master: &mut Master<'_>,
    count: u8,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Vec<FieldImage>, Error> {
    let mut fields = Vec::new();
    for number in 0..count {
        progress(u64::from(number), u64::from(count));
        fields.push(read_field(master, number)?);
    }
    Ok(fields)
}

#[derive(Clone, Debug, PartialEq)]
pub struct UnreadableField {
    pub number: u8,
    /// Status of the field, if it can be read.
    pub status: Option<DataFieldStatus>,
    pub why: Error,
}

/// Reads a field. Returns an inner error with the reason if only this field cannot be read.
///
/// # Errors
/// Returns an error if the encoder no longer replies or the user cancels.
pub fn try_read_field(master: &mut Master<'_>, number: u8) -> Result<Result<FieldImage, UnreadableField>, Error> {
    let status = read_field_status(master, number);
    let status = match separate_value_error(master, status)? {
        Ok(status) => status,
        Err(why) => return Ok(Err(UnreadableField { number, status: None, why })),
    };
    let field = read_field(master, number);
    Ok(separate_value_error(master, field)?.map_err(|why| UnreadableField { number, status: Some(status), why }))
}

/// Returns the error as an inner error if the encoder still replies to other requests.
///
/// # Errors
/// Returns an error if the encoder no longer replies or the user cancels.
pub(super) fn separate_value_error<T>(
    master: &mut Master<'_>,
    result: Result<T, Error>,
) -> Result<Result<T, Error>, Error> {
    match result {
        Ok(value) => Ok(Ok(value)),
        Err(error @ Error::Rejected { .. }) => Ok(Err(error)),
        Err(error @ (Error::Damaged { .. } | Error::NoReply { .. })) => match read_type_label(master) {
            Ok(_) => Ok(Err(error)),
            Err(Error::Cancelled) => Err(Error::Cancelled),
            Err(_) => Err(error),
        },
        Err(error) => Err(error),
    }
}

/// Reads `count` bytes of a field, starting at `address`, in transfers of at most 128 bytes.
///
/// A failed transfer is retried with half the size, until five consecutive transfers have failed. If the line has
/// damaged any data before, each transfer must return the same bytes twice, because an XOR misses some pairs of flipped
/// bits.
///
/// # Errors
/// Returns an error if the exchange fails or the encoder rejects the request.
pub fn read_range(
    master: &mut Master<'_>,
    field: u8,
    address: usize,
    count: usize,
    code: AccessCode,
) -> Result<Vec<u8>, Error> {
    if count == 1 {
        return read_byte(master, field, address, code);
    }
    let mut bytes = Vec::with_capacity(count);
    // A second reading must confirm the first.
    let mut first: Option<Vec<u8>> = None;
    let mut failures = 0;
    let mut in_a_row = 0;
    while bytes.len() < count {
        if bytes.len() + 1 == count {
            bytes.extend(read_byte(master, field, address + bytes.len(), code)?);
            break;
        }
        let chunk = first.as_ref().map_or(master.station().max_transfer.min(count - bytes.len()), Vec::len);
        let request = transfer_request(field, address + bytes.len(), chunk, code)?;
        let trouble = match (read_once(master, &request)?, first.take()) {
            (Ok(again), Some(before)) if again != before => {
                first = Some(again);
                ExchangeFailure::Damage(ReplyDamage::Inconsistent)
            }
            (Ok(once), None) if master.station().requires_double_read() => {
                first = Some(once);
                failures = 0;
                continue;
            }
            (Ok(more), _) => {
                bytes.extend(more);
                failures = 0;
                in_a_row += 1;
                let station = master.station();
                if in_a_row >= 4 && station.max_transfer < MAX_TRANSFER {
                    station.max_transfer *= 2;
                    in_a_row = 0;
                }
                continue;
            }
            (Err(trouble), before) => {
                first = before;
                trouble
            }
        };
        failures += 1;
        in_a_row = 0;
        master.prepare_retry(&request, failures, trouble)?;
        let station = master.station();
        station.max_transfer = (station.max_transfer.min(chunk) / 2).max(MIN_TRANSFER);
        if let Some(first) = &mut first {
            first.truncate(station.max_transfer);
        }
    }
    Ok(bytes)
}

/// Reads one byte in a transfer that includes an adjacent byte. The reply to a single-byte transfer can equal the
/// request, including the access code, and would then look like its echo.
fn read_byte(master: &mut Master<'_>, field: u8, address: usize, code: AccessCode) -> Result<Vec<u8>, Error> {
    let start = address.saturating_sub(1);
    let pair = read_range(master, field, start, 2, code)?;
    Ok(pair.into_iter().skip(address - start).take(1).collect())
}

fn transfer_request(field: u8, address: usize, count: usize, code: AccessCode) -> Result<Request, Error> {
    match (u8::try_from(address), u8::try_from(count)) {
        (Ok(address), Ok(count)) => Ok(Request::ReadData { field, address, count, code }),
        _ => Err(Error::OutOfField { field, address, count, size: MAX_TRANSFER }),
    }
}

fn read_once(master: &mut Master<'_>, request: &Request) -> Result<Result<Vec<u8>, ExchangeFailure>, Error> {
    let answered = match master.exchange_once(request)? {
        Ok(answered) => answered,
        Err(trouble) => return Ok(Err(trouble)),
    };
    match master.resolve_status(request, answered)?.reply {
        Reply::Data(bytes) => Ok(Ok(bytes)),
        other => Err(Error::unexpected_reply(Command::ReadData, &other)),
    }
}
