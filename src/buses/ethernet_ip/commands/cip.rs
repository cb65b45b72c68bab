//! Descriptions of CIP messages: requests, replies, opened and closed connections.

use super::Device;
use crate::bits::hex;
use crate::buses::ethernet_ip::protocol::{
    AddressSource, ConfigurationControl, ConnectionOwner, EPath, ForwardClose, ForwardCloseSuccess, ForwardErrorReply,
    ForwardOpen, ForwardOpenSuccess, GeneralStatus, LogicalKind, NetworkParameters, NetworkType, Reply, Request,
    Segment, Service, class_name, find_extended_status,
};
use crate::cli::output::count;

/// Returns the kind and the description of a message, or `None` if the bytes are not a message.
pub(super) fn message(bytes: &[u8], device: Device) -> Option<(&'static str, Vec<String>)> {
    let request = Request::parse(bytes).ok().filter(|request| is_request(request, device));
    if let Some(request) = request {
        return Some(("request", request_lines(&request, device)));
    }
    let reply = Reply::parse(bytes).ok()?;
    let known = reply.service.name(None).is_some() && bytes.get(1) == Some(&0);
    known.then(|| ("reply", reply_lines(&reply)))
}

/// Returns whether the bytes look like a request. Almost any data can be parsed as one, so the request must also
/// address an object and, for a known device, use a known service.
fn is_request(request: &Request, device: Device) -> bool {
    let class_first = matches!(request.path.0.first(), Some(Segment::Logical { kind: LogicalKind::Class, .. }));
    let whole = !request.path.0.iter().any(|segment| matches!(segment, Segment::Unknown(_)));
    let known = matches!(device, Device::Any) || request.service.name(request.class_id()).is_some();
    class_first && request.path.first_value(LogicalKind::Instance).is_some() && whole && known
}

fn request_lines(request: &Request, device: Device) -> Vec<String> {
    let class = request.class_id();
    let mut lines = vec![format!("CIP request: {} of {}", service_name(request.service, class), path(&request.path))];
    match (request.service, class) {
        (Service::FORWARD_OPEN, Some(Request::CONNECTION_MANAGER)) => match ForwardOpen::parse(&request.data) {
            Ok(asked) => lines.extend(forward_open_lines(&asked)),
            Err(why) => lines.push(format!("{why}: {}", hex(&request.data))),
        },
        (Service::FORWARD_CLOSE, Some(Request::CONNECTION_MANAGER)) => match ForwardClose::parse(&request.data) {
            Ok(asked) => lines.push(format!("{}; {}", owner_name(asked.owner), path(&asked.path))),
            Err(why) => lines.push(format!("{why}: {}", hex(&request.data))),
        },
        _ => lines.extend(attribute_lines(request, device)),
    }
    lines
}

fn attribute_lines(request: &Request, device: Device) -> Vec<String> {
    let data = &request.data;
    let place = request.class_id().zip(request.path.first_value(LogicalKind::Attribute));
    let explained = match (place, device) {
        (Some((ConfigurationControl::CLASS, ConfigurationControl::ATTRIBUTE)), _) => {
            let source = ConfigurationControl::parse(data).map(|control| address_source_text(control.source()));
            Some(("where the address comes from".to_owned(), source.map_err(|why| why.to_string())))
        }
        (Some((class, attribute)), Device::Known(words)) => words(class, attribute, data),
        _ => None,
    };
    match explained {
        Some((name, _)) if data.is_empty() => vec![name],
        Some((name, Ok(value))) => vec![format!("{name} = {value}")],
        Some((name, Err(why))) => vec![format!("{name}; no value, {why}: {}", hex(data))],
        None if data.is_empty() => Vec::new(),
        None => vec![data_text(data)],
    }
}

fn reply_lines(reply: &Reply) -> Vec<String> {
    let mut lines = vec![format!("CIP reply: {}, status {}", service_name(reply.service, None), reply.status)];
    for code in &reply.extended {
        let meaning = find_extended_status(reply.service, reply.status, *code)
            .map_or_else(|| "unknown".to_owned(), |row| format!("{}; {}", row.meaning, row.remedy));
        lines.push(format!("extended status 0x{code:04X} {meaning}"));
    }
    if reply.status != GeneralStatus::OK && reply.extended.is_empty() {
        lines.extend(reply.status.row().map(|row| row.remedy.to_owned()));
    }
    let done = reply.status == GeneralStatus::OK;
    let summary = match (reply.service, done) {
        (Service::FORWARD_OPEN, true) => ForwardOpenSuccess::parse(&reply.data).ok().map(|opened| {
            format!(
                "to the target as 0x{:08X} every {}, to the originator as 0x{:08X} every {}; {}",
                opened.to_target_id,
                interval_text(opened.to_target_interval_us),
                opened.to_originator_id,
                interval_text(opened.to_originator_interval_us),
                owner_name(opened.owner)
            )
        }),
        (Service::FORWARD_CLOSE, true) => {
            ForwardCloseSuccess::parse(&reply.data).ok().map(|closed| owner_name(closed.owner))
        }
        (Service::FORWARD_OPEN | Service::FORWARD_CLOSE, false) => {
            ForwardErrorReply::parse(&reply.data).ok().map(|refused| {
                format!(
                    "{}; {} of the path left",
                    owner_name(refused.owner),
                    count(refused.remaining_path_words.into(), "word")
                )
            })
        }
        _ => None,
    };
    lines.extend(summary.or_else(|| (!reply.data.is_empty()).then(|| data_text(&reply.data))));
    lines
}

fn forward_open_lines(asked: &ForwardOpen) -> Vec<String> {
    let way = |to: &str, id: u32, interval_us: u32, parameters: NetworkParameters| {
        let kind = match parameters.kind() {
            NetworkType::Null => "nothing",
            NetworkType::Multicast => "multicast",
            NetworkType::PointToPoint => "point to point",
            NetworkType::Reserved => "reserved",
        };
        let size = count(parameters.size().into(), "byte");
        format!(
            "to the {to} as 0x{id:08X} every {}: {size}, {kind} (0x{:04X})",
            interval_text(interval_us),
            parameters.to_bits()
        )
    };
    vec![
        way("target", asked.to_target_id, asked.to_target_interval_us, asked.to_target),
        way("originator", asked.to_originator_id, asked.to_originator_interval_us, asked.to_originator),
        format!(
            "{}; ends after {} without data ({} ms to the target); transport 0x{:02X}, class {}; request within {} ms; {}",
            owner_name(asked.owner),
            count(usize::try_from(asked.connection_timeout.interval_multiplier()).unwrap_or(usize::MAX), "interval"),
            asked.target_timeout().as_millis(),
            asked.transport.byte(),
            asked.transport.transport_class(),
            asked.timeout.duration().as_millis(),
            path(&asked.path)
        ),
    ]
}

fn address_source_text(source: AddressSource) -> String {
    match source {
        AddressSource::Stored => "stored in the device".to_owned(),
        AddressSource::Bootp => "BOOTP".to_owned(),
        AddressSource::Dhcp => "DHCP".to_owned(),
        AddressSource::Unknown(number) => format!("method {number}, which is not known"),
    }
}

fn service_name(service: Service, class: Option<u16>) -> String {
    service.name(class).map_or_else(|| format!("service 0x{:02X}", service.code()), str::to_owned)
}

fn path(path: &EPath) -> String {
    let words: Vec<String> = path
        .0
        .iter()
        .map(|segment| match segment {
            Segment::Logical { kind: LogicalKind::Class, number, .. } => {
                let name = class_name(*number).map_or(String::new(), |name| format!(" ({name})"));
                format!("class 0x{number:02X}{name}")
            }
            Segment::Logical { kind: LogicalKind::Instance, number, .. } => format!("instance {number}"),
            Segment::Logical { kind: LogicalKind::Attribute, number, .. } => format!("attribute {number}"),
            Segment::Logical { kind: LogicalKind::ConnectionPoint, number, .. } => format!("connection point {number}"),
            Segment::Key(key) => format!("key of vendor {}, product {}", key.vendor, key.product_code),
            Segment::Data(words) => format!("{} of configuration", count(words.len(), "word")),
            Segment::Unknown(bytes) => format!("unknown segment {}", hex(bytes)),
        })
        .collect();
    words.join(", ")
}

fn owner_name(owner: ConnectionOwner) -> String {
    let ConnectionOwner { connection_serial, vendor, serial_number } = owner;
    format!("connection {connection_serial} of vendor {vendor}, serial number {serial_number}")
}

fn interval_text(microseconds: u32) -> String {
    format!("{} ms", f64::from(microseconds) / 1e3)
}

fn data_text(data: &[u8]) -> String {
    let number = match data {
        [byte] => Some(i64::from(*byte)),
        [a, b] => Some(i64::from(u16::from_le_bytes([*a, *b]))),
        [a, b, c, d] => Some(i64::from(i32::from_le_bytes([*a, *b, *c, *d]))),
        _ => None,
    };
    let text = (data.len() > 4 && data.iter().all(|byte| (b' '..=b'~').contains(byte)))
        .then(|| data.iter().map(|byte| char::from(*byte)).collect::<String>());
    match (number, text) {
        (Some(number), _) => format!("data {} ({number})", hex(data)),
        (None, Some(text)) => format!("data {} (\"{text}\")", hex(data)),
        (None, None) => format!("data {}", hex(data)),
    }
}
