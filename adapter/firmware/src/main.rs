//! Firmware of the adapter for the Raspberry Pi Pico (RP2040). It contains the clocks, the pins, the state machines of
//! the lines, and USB. The adapter's behaviour is implemented in `adapter-core`.

#![no_std]
#![no_main]

extern crate alloc;

mod clocks;
mod converter;
mod line;
mod pins;
mod ring;
mod straps;
mod supply;
mod usb;
mod wake;

use alloc::borrow::ToOwned;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;

use adapter_core::{Adapter, Bus as _, Correction, Identity};
use bridge_codec::RestartReason;
use embedded_alloc::LlffHeap;
use embedded_hal::digital::{OutputPin as _, StatefulOutputPin as _};
use rp2040_hal as hal;

use hal::fugit::ExtU32 as _;
use hal::gpio::PinState;
use hal::pac;
use hal::usb::UsbBus;
use hal::{Sio, Timer, Watchdog};
use usb_device::bus::UsbBusAllocator;

use converter::Converter;
use line::{Line, Pins};
use supply::Switch;

/// Second-stage boot loader, which sets up the flash.
// Safety: the boot loader expects these bytes in this section.
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_GENERIC_03H;

#[global_allocator]
static HEAP: LlffHeap = LlffHeap::empty();
/// Size of the heap in bytes. Up to 32 KiB of it hold bytes that wait for the host.
const HEAP_BYTES: usize = 64 * 1024;

const SERIAL_NUMBER: &str = "1";
/// Maximum duration of a sleep of the main loop in microseconds: during a transfer, during a stream, and otherwise.
const SLEEP_US: [u32; 3] = [200, 2_000, 100_000];
/// Time in milliseconds after which the watchdog restarts an unresponsive adapter.
const WATCHDOG_MS: u32 = 2_000;

#[hal::entry]
fn main() -> ! {
    // Without its peripherals, the adapter waits for the watchdog to restart it.
    let _ = run();
    loop {
        cortex_m::asm::nop();
    }
}

fn run() -> Option<()> {
    static mut MEMORY: [MaybeUninit<u8>; HEAP_BYTES] = [MaybeUninit::uninit(); HEAP_BYTES];
    // Safety: `run` is called once, before anything is allocated, and nothing else uses this memory.
    unsafe { HEAP.init(&raw mut MEMORY as usize, HEAP_BYTES) };

    let mut pac = pac::Peripherals::take()?;
    let restart = restart_reason(&pac.WATCHDOG, &pac.VREG_AND_CHIP_RESET);
    let mut watchdog = Watchdog::new(pac.WATCHDOG);
    watchdog.enable_tick_generation((clocks::CRYSTAL_HZ / 1_000_000) as u8);
    watchdog.start(WATCHDOG_MS.millis());
    let clocks = clocks::start(pac.XOSC, pac.CLOCKS, pac.PLL_SYS, pac.PLL_USB, &mut pac.RESETS).ok()?;
    let mut timer = Timer::new(pac.TIMER, &mut pac.RESETS, &clocks);
    wake::start(&mut timer);

    let sio = Sio::new(pac.SIO);
    let pins = hal::gpio::Pins::new(pac.IO_BANK0, pac.PADS_BANK0, sio.gpio_bank0, &mut pac.RESETS);
    // The line driver stays off until the clock is high.
    let mut driver = pins.gpio4.into_push_pull_output_in_state(PinState::Low);
    let (words, conversions) = ring::rings(pac.DMA, &mut pac.RESETS);
    let inputs = converter::Pins { sine: pins.gpio26, cosine: pins.gpio27, supply: pins.gpio28, board: pins.gpio29 };
    let converter = Converter::new(pac.ADC, conversions, inputs, &mut pac.RESETS)?;
    let line = Line::new(
        pac.PIO0,
        pac.PIO1,
        Pins {
            clock: pins.gpio2.reconfigure(),
            data: pins.gpio3.reconfigure(),
            done: pins.gpio5.reconfigure(),
            serial_out: pins.gpio8.reconfigure(),
            serial_in: pins.gpio9.reconfigure(),
            direction: pins.gpio10.reconfigure(),
        },
        words,
        converter,
        Switch::new(pins.gpio14, pins.gpio15),
        timer,
        &mut pac.RESETS,
    )
    .ok()?;
    let Ok(()) = driver.set_high();
    let capabilities = straps::capabilities(pins.gpio18, pins.gpio19, pins.gpio20);
    let mut led = pins.gpio25.into_push_pull_output();

    let bus = UsbBus::new(pac.USBCTRL_REGS, pac.USBCTRL_DPRAM, clocks.usb_clock, true, &mut pac.RESETS);
    let bus: &'static _ = cortex_m::singleton!(: UsbBusAllocator<UsbBus> = UsbBusAllocator::new(bus))?;
    if !usb::start(bus, SERIAL_NUMBER) {
        return None;
    }
    let mut adapter = Adapter::new(
        line,
        Identity {
            name: usb::PRODUCT,
            serial: SERIAL_NUMBER.to_owned(),
            firmware: env!("CARGO_PKG_VERSION"),
            capabilities,
            restart,
            corrections: [Correction::NONE; 2],
        },
    );
    let mut was_open = false;
    loop {
        watchdog.feed();
        let is_open = usb::is_open();
        if was_open && !is_open {
            adapter.handle_host_disconnect();
        }
        was_open = is_open;

        let mut is_idle = true;
        let mut buffer = [0; 64];
        if adapter.accepts_bytes() {
            let count = usb::read(&mut buffer);
            if let Some(bytes) = buffer.get(..count).filter(|bytes| !bytes.is_empty()) {
                adapter.receive(bytes);
                let Ok(()) = led.toggle();
                is_idle = false;
            }
        }
        adapter.poll();
        let sent = usb::write(adapter.outbox().pending());
        if sent > 0 {
            let now_us = adapter.bus().now_us();
            adapter.outbox().consume(sent, now_us);
            is_idle = false;
        }
        if is_idle {
            let [transfer, stream, idle] = SLEEP_US;
            wake::after(match (adapter.is_transferring(), adapter.is_streaming()) {
                (true, _) => transfer,
                (false, true) => stream,
                (false, false) => idle,
            });
            usb::sleep();
        }
    }
}

/// Returns the reason for the last start. The chip cannot distinguish a supply voltage drop from power-on.
fn restart_reason(watchdog: &pac::WATCHDOG, reset: &pac::VREG_AND_CHIP_RESET) -> RestartReason {
    let cause = reset.chip_reset().read();
    let watchdog = watchdog.reason().read();
    if watchdog.timer().bit_is_set() || watchdog.force().bit_is_set() {
        RestartReason::WATCHDOG
    } else if cause.had_por().bit_is_set() {
        RestartReason::POWER
    } else if cause.had_run().bit_is_set() {
        RestartReason::RESET_PIN
    } else {
        RestartReason::UNKNOWN
    }
}

/// A panic stops the adapter, and the watchdog restarts it.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    loop {
        cortex_m::asm::nop();
    }
}
