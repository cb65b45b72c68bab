//! Modbus/TCP requests and replies for functions 3, 4, 6 and 16. See *MODBUS Messaging on TCP/IP Implementation Guide*
//! V1.0b and *MODBUS Application Protocol* V1.1b3.

use rmodbus::ModbusProto;
use rmodbus::consts::ModbusFunction;
use rmodbus::server::{ModbusFrame, Read};

/// Modbus exception code of a rejected request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Exception {
    Function = 0x01,
    Address = 0x02,
    /// The length or count in the request is invalid.
    Value = 0x03,
    /// The device behind the gateway does not reply. The unit may be wrong, or the device has no power.
    NoAnswer = 0x0B,
}

pub(super) trait Registers {
    fn inputs(&mut self, first: u16, count: u16) -> Result<Vec<u16>, Exception>;
    fn holding_registers(&mut self, first: u16, count: u16) -> Result<Vec<u16>, Exception>;
    fn write(&mut self, first: u16, values: &[u16]) -> Result<(), Exception>;
}

/// Number of bytes before the unit: transaction number, protocol and length.
const PREFIX: usize = 6;
/// Valid values of the length field, which counts the unit, the function code and up to 252 data bytes.
const LENGTHS: std::ops::RangeInclusive<usize> = 2..=254;

/// Removes the next complete frame from the received bytes, or returns `None` if it is incomplete. Bytes that are not
/// Modbus are dropped, since they do not show where the next frame begins.
pub(super) fn next(received: &mut Vec<u8>) -> Option<Vec<u8>> {
    let [_, _, protocol_high, protocol_low, high, low, ..] = *received.as_slice() else { return None };
    let length = usize::from(u16::from_be_bytes([high, low]));
    if (protocol_high, protocol_low) != (0, 0) || !LENGTHS.contains(&length) {
        received.clear();
        return None;
    }
    (received.len() >= PREFIX + length).then(|| received.drain(..PREFIX + length).collect())
}

/// Returns the reply to a complete frame.
pub(super) fn reply_to(request: &[u8], unit: u8, registers: &mut impl Registers) -> Vec<u8> {
    match execute_request(request, unit, registers) {
        Ok(reply) => reply,
        Err(exception) => exception_reply(request, exception),
    }
}

pub(super) fn exception_reply(request: &[u8], exception: Exception) -> Vec<u8> {
    let [high, low, _, _, _, _, unit, function, ..] = *request else { return Vec::new() };
    vec![high, low, 0, 0, 0, 3, unit, function | 0x80, exception as u8]
}

fn execute_request(request: &[u8], unit: u8, registers: &mut impl Registers) -> Result<Vec<u8>, Exception> {
    let [_, _, _, _, _, _, own, function, ref rest @ ..] = *request else { return Err(Exception::Value) };
    if own != unit {
        return Err(Exception::NoAnswer);
    }
    let function = ModbusFunction::try_from(function).map_err(|_| Exception::Function)?;
    let data = check_request(function, rest)?;
    let mut reply = Vec::new();
    let mut frame = ModbusFrame::new(unit, request, ModbusProto::TcpUdp, &mut reply).with_broadcast_units(&[]);
    frame.parse().map_err(|_| Exception::Value)?;
    let (first, count) = (frame.reg, frame.count);
    let done = match function {
        ModbusFunction::GetInputs => fill_reply(&mut frame, &registers.inputs(first, count)?),
        ModbusFunction::GetHoldings => fill_reply(&mut frame, &registers.holding_registers(first, count)?),
        _ => {
            registers.write(first, &data)?;
            frame.process_external_write(Ok(()))
        }
    };
    done.and_then(|()| frame.finalize_response()).map_err(|_| Exception::Value)?;
    Ok(reply)
}

/// Checks the length of the data after the function code and returns the values to be written.
fn check_request(function: ModbusFunction, rest: &[u8]) -> Result<Vec<u16>, Exception> {
    let words = |bytes: &[u8]| bytes.as_chunks().0.iter().copied().map(u16::from_be_bytes).collect();
    match (function, rest) {
        (ModbusFunction::GetInputs | ModbusFunction::GetHoldings, [_, _, high, low]) => {
            match u16::from_be_bytes([*high, *low]) {
                1..=125 => Ok(Vec::new()),
                _ => Err(Exception::Value),
            }
        }
        (ModbusFunction::SetHolding, [_, _, value @ ..]) if value.len() == 2 => Ok(words(value)),
        (ModbusFunction::SetHoldingsBulk, [_, _, high, low, bytes, values @ ..]) => {
            let count = usize::from(u16::from_be_bytes([*high, *low]));
            let fits = (1..=123).contains(&count) && usize::from(*bytes) == 2 * count && values.len() == 2 * count;
            if fits { Ok(words(values)) } else { Err(Exception::Value) }
        }
        (
            ModbusFunction::GetInputs
            | ModbusFunction::GetHoldings
            | ModbusFunction::SetHolding
            | ModbusFunction::SetHoldingsBulk,
            _,
        ) => Err(Exception::Value),
        _ => Err(Exception::Function),
    }
}

fn fill_reply(frame: &mut ModbusFrame<'_, Vec<u8>>, registers: &[u16]) -> Result<(), rmodbus::ErrorKind> {
    if let Read::Words(read) = frame.get_external_read()? {
        read.buf
            .iter_mut()
            .zip(registers.iter().flat_map(|register| register.to_be_bytes()))
            .for_each(|(to, from)| *to = from);
    }
    Ok(())
}
