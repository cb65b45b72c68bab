//! The timer alarm that wakes the main loop.

use core::cell::RefCell;

use critical_section::Mutex;
use rp2040_hal as hal;

use hal::fugit::ExtU32 as _;
use hal::pac::{Interrupt, NVIC, interrupt};
use hal::timer::{Alarm as _, Alarm0, Timer};

static ALARM: Mutex<RefCell<Option<Alarm0>>> = Mutex::new(RefCell::new(None));

/// Enables the interrupt of timer alarm 0, which wakes the main loop.
pub(crate) fn start(timer: &mut Timer) {
    if let Some(mut alarm) = timer.alarm_0() {
        alarm.enable_interrupt();
        critical_section::with(|section| ALARM.borrow(section).replace(Some(alarm)));
        // Safety: the handler only uses state that it locks.
        unsafe { NVIC::unmask(Interrupt::TIMER_IRQ_0) };
    }
}

/// Sets the time until the main loop wakes, in microseconds.
pub(crate) fn after(us: u32) {
    critical_section::with(|section| {
        if let Some(alarm) = ALARM.borrow_ref_mut(section).as_mut() {
            // An alarm that is already due goes off immediately.
            let _ = alarm.schedule(us.micros());
        }
    });
}

#[interrupt]
fn TIMER_IRQ_0() {
    critical_section::with(|section| {
        if let Some(alarm) = ALARM.borrow_ref_mut(section).as_mut() {
            alarm.clear_interrupt();
        }
    });
    crate::usb::cancel_sleep();
}
