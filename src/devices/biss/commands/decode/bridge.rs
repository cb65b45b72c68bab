//! Decoding of bridge packets, each of which ends with a 00 byte.

use serde_json::Map;

use super::{form_map, position};
use crate::bits::{hex, hex_compact};
use crate::buses::bridge::protocol::{
    AdapterStatus, AnalogData, BissData, BissStatus, BodyError, Capabilities, ErrorCode, Hello, Message, Operation,
    Packet, PacketError, Reply, Request, RestartReason, SsiData, StreamData, SupplyFaults,
};
use crate::cli::decode::FrameExplanation;

pub(super) fn explain_packet(bytes: &[u8]) -> Vec<FrameExplanation> {
    if bytes.iter().all(|byte| *byte == 0) {
        let why = "no bridge packet: only zeros, which end one".to_owned();
        return vec![FrameExplanation {
            shown: hex(bytes),
            compact: hex_compact(bytes),
            meaning: Err(why),
            more: form_map("bridge"),
        }];
    }
    let packets = bytes.split(|byte| *byte == 0).filter(|stuffed| !stuffed.is_empty());
    packets
        .map(|stuffed| {
            let meaning = match Packet::parse(stuffed) {
                Ok(packet) => explain_message(&packet),
                Err(PacketError::Crc { expected, got }) => {
                    Err(format!("CRC-16 of the bridge packet is {got:04X} where {expected:04X} was expected"))
                }
                Err(error) => Err(format!("no bridge packet: {error}")),
            };
            FrameExplanation { shown: hex(stuffed), compact: hex_compact(stuffed), meaning, more: form_map("bridge") }
        })
        .collect()
}

fn explain_message(packet: &Packet) -> Result<Vec<String>, String> {
    let unknown = |error: BodyError| format!("a bridge packet that this program does not know: {error}");
    let seq = packet.seq;
    if packet.op & Operation::REPLY_BIT == 0 {
        let request = Request::parse(packet).map_err(unknown)?;
        let mut lines = vec![format!("request {seq}: {}", name(request.operation()))];
        lines.extend(request_text(&request));
        return Ok(lines);
    }
    match Message::parse(packet) {
        Ok(Message::Reply(reply)) => {
            let mut lines = vec![format!("reply to request {seq}: {}", name(reply.operation()))];
            lines.extend(explain_reply(&reply)?);
            Ok(lines)
        }
        Ok(Message::Error { op, code, text }) => {
            let of = Operation::from_byte(op).map_or_else(|| format!("operation 0x{op:02X}"), |op| name(op).to_owned());
            Ok(vec![format!("refusal of request {seq}: {of}"), format!("{}: {text}", explain_rejection(code))])
        }
        Ok(Message::Data(data)) => explain_stream(seq, &data),
        Err(error) => Err(unknown(error)),
    }
}

/// Returns the name of an operation as in the bridge reference.
fn name(operation: Operation) -> &'static str {
    match operation {
        Operation::Hello => "HELLO",
        Operation::Supply => "SUPPLY",
        Operation::Status => "STATUS",
        Operation::SsiConfig => "SSI_CONFIG",
        Operation::SsiRead => "SSI_READ",
        Operation::SsiStream => "SSI_STREAM",
        Operation::BissConfig => "BISS_CONFIG",
        Operation::BissRead => "BISS_READ",
        Operation::BissRegisterRead => "BISS_REG_READ",
        Operation::BissRegisterWrite => "BISS_REG_WRITE",
        Operation::BissStream => "BISS_STREAM",
        Operation::AnalogConfig => "ANALOG_CONFIG",
        Operation::AnalogStream => "ANALOG_STREAM",
        Operation::AnalogSkew => "ANALOG_SKEW",
        Operation::UartConfig => "UART_CONFIG",
        Operation::UartTransfer => "UART_TRANSFER",
    }
}

fn request_text(request: &Request) -> Option<String> {
    let switch = |on: bool| if on { "on" } else { "off" };
    Some(match request {
        Request::Hello | Request::Status | Request::SsiRead | Request::BissRead | Request::AnalogSkew => return None,
        Request::Supply { on, millivolt } => format!("{}, {millivolt} mV", switch(*on)),
        Request::SsiConfig { clocks, clock_hz, pause_us, flags } => {
            let edge = if flags.falling_edge() { "falling" } else { "rising" };
            format!("{clocks} clocks at {clock_hz} Hz, {pause_us} µs pause, sampled on the {edge} edge")
        }
        Request::SsiStream { period_us: 0 } | Request::BissStream { period_us: 0 } => "end".to_owned(),
        Request::SsiStream { period_us } | Request::BissStream { period_us } => format!("every {period_us} µs"),
        Request::BissConfig { clock_hz, data_bits, crc_bits, timeout_us } => {
            format!("{clock_hz} Hz, {data_bits} data bits, {crc_bits} CRC bits, time-out {timeout_us} µs")
        }
        Request::BissRegisterRead { slave, address } => format!("slave {slave}, register 0x{address:02X}"),
        Request::BissRegisterWrite { slave, address, value } => {
            format!("slave {slave}, register 0x{address:02X} = 0x{value:02X}")
        }
        Request::AnalogConfig { sample_hz } => format!("{sample_hz} samples a second"),
        Request::AnalogStream { on } => switch(*on).to_owned(),
        Request::UartConfig { baud, parity, turnaround_us } => {
            let parity = ["none", "odd", "even"].get(usize::from(*parity)).copied().unwrap_or("unknown");
            format!("{baud} bit/s, parity {parity}, turnaround {turnaround_us} µs")
        }
        Request::UartTransfer { timeout_us, idle_us, tx } => {
            format!("sends {}; time-out {timeout_us} µs, idle {idle_us} µs", hex(tx))
        }
    })
}

fn explain_reply(reply: &Reply) -> Result<Vec<String>, String> {
    let switch = |on: bool| if on { "on" } else { "off" };
    Ok(match reply {
        Reply::Hello(hello) => hello_reply_lines(hello),
        Reply::Supply { on, millivolt, milliampere } => {
            vec![format!("{}, {millivolt} mV, {milliampere} mA", switch(*on))]
        }
        Reply::Status(status) => status_lines(status),
        Reply::SsiConfig { clock_hz } | Reply::BissConfig { clock_hz } => vec![format!("{clock_hz} Hz")],
        Reply::SsiRead { t_us, raw } => vec![format!("{:.6} s: 0x{raw:X}", to_seconds(*t_us))],
        Reply::SsiStream { period_us } | Reply::BissStream { period_us } => vec![format!("every {period_us} µs")],
        Reply::BissRead { t_us, status, raw } => explain_frame(to_seconds(*t_us), *status, *raw)?,
        Reply::BissRegisterRead { value } | Reply::BissRegisterWrite { value } => vec![format!("value 0x{value:02X}")],
        Reply::AnalogConfig { sample_hz, full_scale_microvolt, bits } => {
            vec![format!("{sample_hz} samples a second, full scale {full_scale_microvolt} µV, {bits} bits")]
        }
        Reply::AnalogStream { on } => vec![switch(*on).to_owned()],
        Reply::AnalogSkew { skew_ns } => vec![format!("cosine {skew_ns} ns after sine")],
        Reply::UartConfig { baud } => vec![format!("{baud} bit/s")],
        Reply::UartTransfer { t_us, rx } => vec![format!("{:.6} s: received {}", to_seconds(*t_us), hex(rx))],
    })
}

fn status_lines(status: &AdapterStatus) -> Vec<String> {
    let restart = match status.restart {
        RestartReason::POWER => "power-on or low voltage".to_owned(),
        RestartReason::RESET_PIN => "reset pin".to_owned(),
        RestartReason::WATCHDOG => "watchdog".to_owned(),
        other => format!("reason {}", other.byte()),
    };
    let overload = if status.faults == SupplyFaults::NONE { "no supply fault" } else { "supply overloaded" };
    vec![
        format!("{:.6} s since the start: {restart}", to_seconds(status.t_us)),
        format!("{overload}, {} mV before the switch", status.input_millivolt),
        format!("{} damaged and {} malformed packets, {} samples lost", status.damaged, status.malformed, status.lost),
    ]
}

fn hello_reply_lines(hello: &Hello) -> Vec<String> {
    let can = [
        (Capabilities::SSI, "SSI"),
        (Capabilities::BISS, "BiSS position"),
        (Capabilities::BISS_REGISTERS, "BiSS registers"),
        (Capabilities::ANALOG, "analogue signals"),
        (Capabilities::UART, "RS-485 UART"),
        (Capabilities::SUPPLY, "switched supply"),
        (Capabilities::STATUS, "status"),
    ];
    let can: Vec<&str> =
        can.into_iter().filter(|(one, _)| hello.capabilities.contains(*one)).map(|(_, name)| name).collect();
    vec![
        format!("{}, serial number {}, firmware {}", hello.name, hello.serial, hello.firmware),
        format!("can: {}", can.join(", ")),
        format!("clock up to {} Hz, up to {} samples a second", hello.max_clock_hz, hello.max_sample_hz),
    ]
}

/// Describes a frame from an adapter. The adapter does not check the CRC, so it is checked here.
fn explain_frame(t_s: f64, status: BissStatus, raw: u64) -> Result<Vec<String>, String> {
    let bad = match status {
        BissStatus::OK => {
            let lines = position::explain_fields(raw, &mut Map::new())
                .map_err(|why| format!("at {t_s:.6} s, frame 0x{raw:011X}: {why}"))?;
            return Ok(std::iter::once(format!("{t_s:.6} s: 0x{raw:011X}")).chain(lines).collect());
        }
        BissStatus::NO_ACKNOWLEDGE => "no acknowledge",
        BissStatus::STUCK_LOW => "the line is stuck low",
        BissStatus::STUCK_HIGH => "the line is stuck high",
        _ => "unknown status",
    };
    Ok(vec![format!("{t_s:.6} s: {bad} (status {})", status.byte())])
}

fn explain_stream(seq: u8, data: &StreamData) -> Result<Vec<String>, String> {
    let (first, count, lost) = data.sample_range();
    let head = |what: &str, t0_us: u64| {
        let lost = if lost > 0 { format!(", {lost} lost before them") } else { String::new() };
        format!("stream packet {seq}: {count} {what} from number {first} on, from {:.6} s{lost}", to_seconds(t0_us))
    };
    let time =
        |t0_us: u64, period_us: u32, at: u64| to_seconds(t0_us.saturating_add(at.saturating_mul(period_us.into())));
    Ok(match data {
        StreamData::Ssi(SsiData { t0_us, period_us, values, .. }) => {
            let words =
                values.iter().zip(0..).map(|(raw, at)| format!("{:.6} s: 0x{raw:X}", time(*t0_us, *period_us, at)));
            std::iter::once(head("SSI words", *t0_us)).chain(words).collect()
        }
        StreamData::Biss(BissData { t0_us, period_us, values, .. }) => {
            let mut lines = vec![head("BiSS frames", *t0_us)];
            for ((status, raw), at) in values.iter().zip(0..) {
                lines.extend(explain_frame(time(*t0_us, *period_us, at), *status, *raw)?);
            }
            lines
        }
        StreamData::Analog(AnalogData { t0_us, samples, .. }) => {
            let words = samples.iter().map(|(sine, cosine)| format!("sine {sine}, cosine {cosine}"));
            std::iter::once(head("analogue samples", *t0_us)).chain(words).collect()
        }
    })
}

fn explain_rejection(code: ErrorCode) -> String {
    match code {
        ErrorCode::NOT_SUPPORTED => "not supported".to_owned(),
        ErrorCode::BAD_ARGUMENT => "bad argument".to_owned(),
        ErrorCode::BUSY => "busy".to_owned(),
        ErrorCode::NO_REPLY => "the device does not answer".to_owned(),
        ErrorCode::INVALID_REPLY => "the device answered wrongly".to_owned(),
        ErrorCode::OVERRUN => "overrun".to_owned(),
        other => format!("code {}", other.byte()),
    }
}

fn to_seconds(microseconds: u64) -> f64 {
    microseconds as f64 / 1e6
}
