//! Tests of a virtual encoder on a virtual adapter's serial line, from the perspective of a host.

use crate::buses::bridge::protocol::*;
use crate::buses::bridge::sim::tests::Host;
use crate::devices::hiperface::sim::AttachableEncoder;

/// The reply begins after eleven bits per character, 44 bits of silence, and half of the maximum of 5 ms for the
/// command.
#[test]
fn adapter_uart_reaches_encoder() {
    let mut host = Host::to("uart=hiperface", &[&AttachableEncoder]);
    let Some(Message::Reply(Reply::Hello(hello))) = host.ask(Request::Hello) else { panic!() };
    assert!(hello.capabilities.contains(Capabilities::UART));
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
    // No encoder has this address, so the transfer ends with the time-out after three characters.
    let sent = host.now.since_start().as_micros() as u64;
    let nothing = Reply::UartTransfer { t_us: sent + 3_437 + 20_000, rx: vec![] };
    host.expect(transfer(&[0x41, 0x50, 0x11]), nothing);
    // At a different baud rate, there is no valid reply.
    host.ask(Request::UartConfig { baud: 19_200, parity: 2, turnaround_us: 0 });
    let Some(Message::Reply(Reply::UartTransfer { rx, .. })) = host.ask(transfer(&[0x40, 0x50, 0x10])) else {
        panic!()
    };
    assert_ne!(rx, [0x40, 0x50, 0x00, 0x10]);
}
