//! The adapter's own line with its faults, and the serial line behind it.

use super::*;
use crate::sim::Faults;

#[test]
fn faults_of_the_adapters_line() {
    assert_eq!(Host::with("fault=drop:1").ask(Request::Hello), None);
    assert_eq!(Host::with("fault=silent-after:0").ask(Request::Hello), None);
    let mut host = Host::with("fault=silent-after:2");
    host.ask(BISS);
    host.ask(Request::BissStream { period_us: 1000 });
    assert!(!host.stream(100).is_empty());
    assert_eq!(host.ask(Request::Hello), None);
    assert_eq!(host.stream(100), [], "what is silent does not stream");
    host.adapter.set_faults(&Faults::default());
    assert!(host.ask(Request::Hello).is_some());
    let mut host = Host::with("fault=delay:50");
    host.send(&Request::Hello);
    assert_eq!(host.adapter.poll_at(), Some(Moment::START + Duration::from_micros(50_250)));
    let mut host = Host::with("fault=flip:0.002&seed=1");
    host.send(&BISS);
    host.send(&Request::BissStream { period_us: 100 });
    host.stream(2_000);
    assert!(host.receiver.dropped() > 0);
    let mut host = Host::with("fault=die-in-store:1");
    host.ask(BISS);
    for (address, value) in [(0x6B, 0x2A), (0x6A, 0x07), (0x40, 0x01)] {
        host.expect(Request::BissRegisterWrite { slave: 0, address, value }, Reply::BissRegisterWrite { value });
    }
    host.refuses(Request::BissRegisterWrite { slave: 0, address: 0, value: 1 }, ErrorCode::NO_ANSWER);
    assert!(!host.adapter.encoder_mut().has_power());
    host.adapter.connect(host.now);
    assert!(host.adapter.encoder().has_power());
}

/// The reference's question for the status and its answer; the times are those of HIPERFACE: eleven bits a character,
/// 44 bits of silence, half of the five milliseconds that the command may take.
#[test]
fn the_serial_line_leads_to_a_hiperface_encoder() {
    let mut host = Host::with("uart=hiperface");
    let Some(Message::Reply(Reply::Hello(hello))) = host.ask(Request::Hello) else { panic!() };
    assert!(hello.capabilities.has(Capabilities::UART));
    let transfer = |tx: &[u8]| Request::UartTransfer { timeout_us: 20_000, idle_us: 5_000, tx: tx.to_vec() };
    host.refuses(transfer(&[0x40, 0x50, 0x10]), ErrorCode::BAD_ARGUMENT);
    host.refuses(Request::UartConfig { baud: 0, parity: 2, turnaround_us: 0 }, ErrorCode::BAD_ARGUMENT);
    host.refuses(Request::UartConfig { baud: 9600, parity: 3, turnaround_us: 0 }, ErrorCode::BAD_ARGUMENT);
    host.expect(Request::UartConfig { baud: 9600, parity: 2, turnaround_us: 0 }, Reply::UartConfig { baud: 9600 });
    let sent = host.now.since_start().as_micros() as u64;
    let Some(Message::Reply(Reply::UartTransfer { t_us, rx })) = host.ask(transfer(&[0x40, 0x50, 0x10])) else {
        panic!()
    };
    assert_eq!(rx, [0x40, 0x50, 0x00, 0x10]);
    assert_eq!(t_us - sent, 3_437 + 4_583 + 2_500);
    // Nobody is at another address: the wait ends with the time-out, after three characters.
    let sent = host.now.since_start().as_micros() as u64;
    let nothing = Reply::UartTransfer { t_us: sent + 3_437 + 20_000, rx: vec![] };
    host.expect(transfer(&[0x41, 0x50, 0x11]), nothing);
    // At another speed there is nothing but silence either.
    host.ask(Request::UartConfig { baud: 19_200, parity: 2, turnaround_us: 0 });
    let Some(Message::Reply(Reply::UartTransfer { rx, .. })) = host.ask(transfer(&[0x40, 0x50, 0x10])) else {
        panic!()
    };
    assert_ne!(rx, [0x40, 0x50, 0x00, 0x10]);
}
