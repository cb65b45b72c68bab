//! The USB serial port. The interrupt handler serves the USB host and receives its bytes, even while the main loop
//! waits for an encoder. When the buffer is full, the interrupt is masked and the host must wait until the main loop
//! has read some bytes.

use core::cell::RefCell;
use core::sync::atomic::{AtomicBool, Ordering};

use critical_section::Mutex;
use rp2040_hal as hal;

use hal::pac::{Interrupt, NVIC, interrupt};
use hal::usb::UsbBus;
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbVidPid};
use usbd_serial::SerialPort;

/// USB ID that open projects share for serial ports; see `docs/adapter.md`. The descriptor strings distinguish the
/// devices.
const ID: UsbVidPid = UsbVidPid(0x16C0, 0x27DD);
const MANUFACTURER: &str = "encoder-studio.example";
pub(crate) const PRODUCT: &str = "Encoder adapter";

/// Whether an event has occurred since the last sleep.
static EVENT: AtomicBool = AtomicBool::new(false);
static PORT: Mutex<RefCell<Option<Port>>> = Mutex::new(RefCell::new(None));

/// Maximum length of a USB packet in bytes.
const PACKET: usize = 64;
/// Size of the buffer for received bytes that the main loop has not read yet.
const RECEIVE_BUFFER_BYTES: usize = 8 * PACKET;

struct Port {
    device: UsbDevice<'static, UsbBus>,
    serial: SerialPort<'static, UsbBus>,
    received: [u8; RECEIVE_BUFFER_BYTES],
    count: usize,
}

impl Port {
    /// Serves the USB host. Returns whether all received bytes fit in the buffer.
    fn serve(&mut self) -> bool {
        self.device.poll(&mut [&mut self.serial]);
        while let Some(room) = self.received.get_mut(self.count..).filter(|room| room.len() >= PACKET) {
            match self.serial.read(room) {
                Ok(count) if count > 0 => self.count += count,
                _ => return true,
            }
        }
        false
    }
}

/// Connects the device to the USB host.
pub(crate) fn start(bus: &'static UsbBusAllocator<UsbBus>, serial_number: &'static str) -> bool {
    let serial = SerialPort::new(bus);
    let strings = StringDescriptors::default().manufacturer(MANUFACTURER).product(PRODUCT).serial_number(serial_number);
    let Ok(builder) = UsbDeviceBuilder::new(bus, ID).strings(&[strings]) else { return false };
    let Ok(builder) = builder.max_packet_size_0(64) else { return false };
    let device = builder.device_class(usbd_serial::USB_CLASS_CDC).build();
    critical_section::with(|section| {
        PORT.borrow(section).replace(Some(Port { device, serial, received: [0; RECEIVE_BUFFER_BYTES], count: 0 }))
    });
    unmask();
    true
}

fn with<R>(act: impl FnOnce(&mut Port) -> R) -> Option<R> {
    critical_section::with(|section| PORT.borrow_ref_mut(section).as_mut().map(act))
}

fn unmask() {
    // Safety: the handler only uses state that it locks.
    unsafe { NVIC::unmask(Interrupt::USBCTRL_IRQ) };
}

/// Moves received bytes into the buffer and returns their number.
pub(crate) fn read(buffer: &mut [u8; PACKET]) -> usize {
    let count = with(|port| {
        let count = port.count.min(PACKET);
        if let Some((bytes, received)) = buffer.get_mut(..count).zip(port.received.get(..count)) {
            bytes.copy_from_slice(received);
        }
        port.received.copy_within(count..port.count, 0);
        port.count -= count;
        count
    });
    unmask();
    count.unwrap_or(0)
}

/// Passes bytes to the USB host and returns how many were accepted.
pub(crate) fn write(bytes: &[u8]) -> usize {
    with(|port| {
        let count = if bytes.is_empty() { 0 } else { port.serial.write(bytes).unwrap_or(0) };
        // An error means that the host has not fetched the previous packet yet. The interrupt handler continues later.
        let _ = port.serial.flush();
        count
    })
    .unwrap_or(0)
}

/// Returns whether a program has opened the port.
pub(crate) fn is_open() -> bool {
    with(|port| port.device.state() == UsbDeviceState::Configured && port.serial.dtr()).unwrap_or(false)
}

/// Sleeps until the next interrupt, or returns at once if there was an interrupt since the last call.
pub(crate) fn sleep() {
    critical_section::with(|_| {
        // An interrupt from here on stays pending and ends the sleep.
        if !EVENT.swap_false() {
            cortex_m::asm::wfi();
        }
    });
}

/// Atomic swap with interrupts disabled, for a processor without atomic exchange.
trait SwapFalse {
    fn swap_false(&self) -> bool;
}

impl SwapFalse for AtomicBool {
    fn swap_false(&self) -> bool {
        let was = self.load(Ordering::Relaxed);
        self.store(false, Ordering::Relaxed);
        was
    }
}

#[interrupt]
fn USBCTRL_IRQ() {
    if with(Port::serve) == Some(false) {
        NVIC::mask(Interrupt::USBCTRL_IRQ);
    }
    EVENT.store(true, Ordering::Relaxed);
}

/// Ends the current or next sleep; see `wake`.
pub(crate) fn cancel_sleep() {
    EVENT.store(true, Ordering::Relaxed);
}
