//! The clock and data lines. PIO 1 runs the state machines for SSI, and PIO 0 those for BiSS. A pacer on each starts
//! the frames of a stream. The clock pin is connected to one of the two PIO blocks.

mod machine;
mod serial;

use adapter_core::{AnalogSetting, BissSetting, Bus, Clocking, Frame, FrameWords, MAX_WORDS, UartSetting};
use rp2040_hal as hal;

use hal::gpio::bank0::{Gpio2, Gpio3, Gpio5, Gpio8, Gpio9, Gpio10};
use hal::gpio::{Function, FunctionNull, FunctionPio0, FunctionPio1, Pin, PullNone};
use hal::pac::{IO_BANK0, PIO0, PIO1, RESETS};
use hal::pio::{
    InstallError, MovStatusConfig, PIO, PIOBuilder, PIOExt as _, PinDir, PinState, SM0, SM1, SM3, ShiftDirection,
};
use hal::timer::Timer;

use crate::clocks::SYSTEM_HZ;
use crate::converter::Converter;
use crate::pins::{BISS_DONE_PIN, CLOCK, DATA, DIRECTION, SERIAL_IN, SERIAL_OUT, SUPPLY_INPUT};
use crate::ring::{self, Ring};
use crate::supply::{self, Switch};
use machine::Machine;
use serial::Serial;

/// Number of cycles from the start of a frame to the first falling clock edge, for SSI and for BiSS.
const START_CYCLES: u32 = 3;
const BISS_START_CYCLES: u32 = 5;
/// Number of system clock cycles per microsecond. A pacer counts microseconds, so this is also its divisor.
const CYCLES_PER_US: u16 = (SYSTEM_HZ / 1_000_000) as u16;
/// Time in microseconds that a pacer adds to its count.
const PACER_US: u32 = 3;
/// Number of the PIO interrupt flag that starts a frame.
const START: u8 = 1;

/// The pins of the lines.
pub(crate) struct Pins<C: Function, D: Function, E: Function> {
    pub(crate) clock: Pin<Gpio2, C, PullNone>,
    pub(crate) data: Pin<Gpio3, D, PullNone>,
    pub(crate) done: Pin<Gpio5, E, PullNone>,
    pub(crate) serial_out: Pin<Gpio8, C, PullNone>,
    pub(crate) serial_in: Pin<Gpio9, D, PullNone>,
    pub(crate) direction: Pin<Gpio10, C, PullNone>,
}

/// The clock and data lines with their state machines, the serial line, the supply, and the analogue inputs.
pub(crate) struct Line {
    timer: Timer,
    ring: Ring,
    converter: Converter,
    is_converting: bool,
    switch: Switch,
    clocking: Option<Clocking>,
    ssi_block: PIO<PIO1>,
    ssi: Machine<(PIO1, SM0)>,
    ssi_pacer: Machine<(PIO1, SM3)>,
    serial: Serial,
    biss_block: PIO<PIO0>,
    ma: Machine<(PIO0, SM0)>,
    slo: Machine<(PIO0, SM1)>,
    biss_pacer: Machine<(PIO0, SM3)>,
    _pins: Pins<FunctionPio1, FunctionPio1, FunctionPio0>,
}

impl Line {
    /// Loads the programs and starts the state machines, which then wait with the clock high.
    pub(crate) fn new(
        pio0: PIO0,
        pio1: PIO1,
        pins: Pins<FunctionNull, FunctionNull, FunctionNull>,
        ring: Ring,
        converter: Converter,
        switch: Switch,
        timer: Timer,
        resets: &mut RESETS,
    ) -> Result<Self, InstallError> {
        let (mut ssi_block, sm0, sm1, sm2, sm3) = pio1.split(resets);
        let (ssi, ssi_pacer) = {
            let program = ssi_block.install(&pio::pio_file!("pio/ssi.pio").program)?;
            let start = program.wrap_target();
            let (mut sm, rx, tx) = PIOBuilder::from_installed_program(program)
                .side_set_pin_base(CLOCK)
                .in_pin_base(DATA)
                .in_shift_direction(ShiftDirection::Left)
                .autopush(true)
                .push_threshold(32)
                .build(sm0);
            sm.set_pins([(CLOCK, PinState::High)]);
            sm.set_pindirs([(CLOCK, PinDir::Output), (DATA, PinDir::Input)]);
            (Machine::new(sm.start(), rx, tx, start, Some(1)), pacer!(ssi_block, sm3))
        };
        let serial = {
            let program = pio::pio_file!("pio/uart.pio", select_program("uart_tx")).program;
            let program = ssi_block.install(&program)?;
            let start = program.wrap_target();
            let (mut sm, rx, tx) = PIOBuilder::from_installed_program(program)
                .side_set_pin_base(DIRECTION)
                .out_pins(SERIAL_OUT, 1)
                .out_shift_direction(ShiftDirection::Right)
                .set_mov_status_config(MovStatusConfig::Tx(1))
                .build(sm1);
            sm.set_pins([(SERIAL_OUT, PinState::High), (DIRECTION, PinState::Low)]);
            sm.set_pindirs([(SERIAL_OUT, PinDir::Output), (DIRECTION, PinDir::Output)]);
            let sender = Machine::new(sm.start(), rx, tx, start, Some(0));
            let program = pio::pio_file!("pio/uart.pio", select_program("uart_rx")).program;
            let program = ssi_block.install(&program)?;
            let start = program.offset();
            let (mut sm, rx, tx) = PIOBuilder::from_installed_program(program)
                .in_pin_base(SERIAL_IN)
                .in_shift_direction(ShiftDirection::Right)
                .build(sm2);
            sm.set_pindirs([(SERIAL_IN, PinDir::Input)]);
            Serial::new(sender, Machine::new(sm.start(), rx, tx, start, None))
        };
        let (mut biss_block, sm0, sm1, _, sm3) = pio0.split(resets);
        let mut ma = {
            let program = pio::pio_file!("pio/biss.pio", select_program("biss_ma")).program;
            let program = biss_block.install(&program)?;
            let start = program.wrap_target();
            let (mut sm, rx, tx) =
                PIOBuilder::from_installed_program(program).side_set_pin_base(CLOCK).jmp_pin(BISS_DONE_PIN).build(sm0);
            sm.set_pins([(CLOCK, PinState::High)]);
            sm.set_pindirs([(CLOCK, PinDir::Output)]);
            Machine::new(sm.start(), rx, tx, start, Some(1))
        };
        ma.clear_x();
        let slo = {
            let program = pio::pio_file!("pio/biss.pio", select_program("biss_slo")).program;
            let program = biss_block.install(&program)?;
            let start = program.wrap_target();
            let (mut sm, rx, tx) = PIOBuilder::from_installed_program(program)
                .side_set_pin_base(BISS_DONE_PIN)
                .in_pin_base(DATA)
                .jmp_pin(DATA)
                .in_shift_direction(ShiftDirection::Left)
                .autopush(true)
                .push_threshold(32)
                .build(sm1);
            sm.set_pins([(BISS_DONE_PIN, PinState::Low)]);
            sm.set_pindirs([(BISS_DONE_PIN, PinDir::Output), (DATA, PinDir::Input)]);
            Machine::new(sm.start(), rx, tx, start, Some(0))
        };
        let biss_pacer = pacer!(biss_block, sm3);
        let pins = Pins {
            clock: pins.clock.into_function::<FunctionPio1>(),
            data: pins.data.into_function::<FunctionPio1>(),
            done: pins.done.into_function::<FunctionPio0>(),
            serial_out: pins.serial_out.into_function::<FunctionPio1>(),
            serial_in: pins.serial_in.into_function::<FunctionPio1>(),
            direction: pins.direction.into_function::<FunctionPio1>(),
        };
        let clocking = None;
        Ok(Line {
            timer,
            ring,
            converter,
            is_converting: false,
            switch,
            clocking,
            ssi_block,
            ssi,
            ssi_pacer,
            serial,
            biss_block,
            ma,
            slo,
            biss_pacer,
            _pins: pins,
        })
    }

    /// Returns the time from the start of a frame to its first falling clock edge, rounded to microseconds.
    fn start_us(&self) -> u64 {
        let cycles = match self.clocking {
            Some(Clocking::Ssi(setting)) => START_CYCLES * u32::from(setting.divisor),
            Some(Clocking::Biss(setting)) => BISS_START_CYCLES * u32::from(setting.divisor),
            None => 0,
        };
        u64::from((cycles + u32::from(CYCLES_PER_US) / 2) / u32::from(CYCLES_PER_US))
    }

    fn begin_frame(&self) {
        match self.clocking {
            Some(Clocking::Ssi(_)) => self.ssi_block.force_irq(START),
            Some(Clocking::Biss(_)) => self.biss_block.force_irq(START),
            None => {}
        }
    }

    fn receive(&mut self) -> u32 {
        match self.clocking {
            Some(Clocking::Ssi(_)) => self.ssi.receive(),
            Some(Clocking::Biss(_)) => self.slo.receive(),
            None => 0,
        }
    }

    /// Returns the number of bits in a frame and its maximum duration in microseconds.
    fn extent(&self) -> (u8, u32) {
        match self.clocking {
            Some(Clocking::Ssi(setting)) => (setting.clocks, setting.burst_us()),
            Some(Clocking::Biss(setting)) => (setting.sampled_bits(), setting.frame_us()),
            None => (0, 0),
        }
    }
}

/// Sets up a state machine of a PIO block as a pacer, which starts the frames of a stream.
macro_rules! pacer {
    ($block:ident, $machine:ident) => {{
        let program = $block.install(&pio::pio_file!("pio/pacer.pio").program)?;
        let start = program.offset();
        let (sm, rx, tx) =
            PIOBuilder::from_installed_program(program).clock_divisor_fixed_point(CYCLES_PER_US, 0).build($machine);
        Machine::new(sm.start(), rx, tx, start, None)
    }};
}
use pacer;

impl Bus for Line {
    const CAPACITY: u32 = ring::WORDS;
    const CONVERSIONS: u32 = ring::CONVERSIONS;

    fn now_us(&self) -> u64 {
        self.timer.get_counter().ticks()
    }

    fn wait_until(&mut self, t_us: u64) {
        while self.now_us() < t_us {}
    }

    fn select(&mut self, clocking: Clocking) {
        match clocking {
            Clocking::Ssi(setting) => {
                self.ssi.set_divisor(setting.divisor);
                self.ssi.load_y(u32::from(setting.clocks) - 1);
            }
            Clocking::Biss(setting) => {
                self.ma.set_divisor(setting.divisor);
                self.slo.set_divisor(setting.divisor);
                self.slo.load_y(setting.search_steps());
                self.slo.load_osr(setting.bits.into());
            }
        }
        connect_clock(clocking);
        self.clocking = Some(clocking);
    }

    fn frame(&mut self, cdm: bool) -> Frame {
        if let Some(Clocking::Biss(BissSetting { timeout_us, divisor, .. })) = self.clocking
            && cdm
        {
            let cycles = (u32::from(timeout_us) + 1) * u32::from(CYCLES_PER_US) / u32::from(divisor);
            self.ma.send(cycles);
        }
        // The time must be read directly before the frame starts.
        let t_us = critical_section::with(|_| {
            let t_us = self.now_us();
            self.begin_frame();
            t_us
        });
        let count = usize::from(FrameWords::count(self.extent().0));
        let mut words = [0; MAX_WORDS];
        for word in words.iter_mut().take(count) {
            *word = self.receive();
        }
        Frame { t_us: t_us + self.start_us(), words: FrameWords(words) }
    }

    fn start(&mut self, period_us: u32) -> u64 {
        let (fifo, request) = match self.clocking {
            Some(Clocking::Biss(_)) => self.slo.output(),
            _ => self.ssi.output(),
        };
        self.ring.start(fifo, request);
        let count = period_us.saturating_sub(PACER_US);
        // The pacer raises the flag a microsecond after it has taken the interval.
        let t_us = critical_section::with(|_| {
            match self.clocking {
                Some(Clocking::Biss(_)) => {
                    self.biss_pacer.send(count);
                    while !self.biss_pacer.has_consumed_all() {}
                }
                _ => {
                    self.ssi_pacer.send(count);
                    while !self.ssi_pacer.has_consumed_all() {}
                }
            }
            self.now_us()
        });
        t_us + 1 + self.start_us()
    }

    fn stop(&mut self) {
        self.ssi_pacer.restart();
        self.biss_pacer.restart();
        // Wait until the last frame has ended.
        let end = self.now_us() + u64::from(self.extent().1) + 2;
        self.wait_until(end);
        self.ring.stop();
        self.ssi_block.clear_irq(START);
        self.biss_block.clear_irq(START);
        self.ssi.discard();
        self.slo.discard();
    }

    fn received(&self) -> u32 {
        self.ring.received()
    }

    fn word(&self, number: u32) -> u32 {
        self.ring.value(number)
    }

    fn supply_millivolt(&mut self) -> u16 {
        if !self.is_converting {
            return supply::millivolt(self.converter.measure(SUPPLY_INPUT));
        }
        // The latest conversion of the input.
        let latest = self.converter.converted().saturating_sub(1);
        let number = latest - (latest + AnalogSetting::INPUTS - SUPPLY_INPUT) % AnalogSetting::INPUTS;
        supply::millivolt(self.converter.value(number))
    }

    fn switch_supply(&mut self, on: bool) {
        self.switch.set(on);
    }

    fn has_supply_fault(&mut self) -> bool {
        self.switch.has_fault()
    }

    fn configure_uart(&mut self, setting: UartSetting) {
        self.serial.configure(setting);
    }

    fn begin_transfer(&mut self, characters: &[u32]) {
        let now = self.now_us() as u32;
        self.serial.begin(characters, now);
    }

    fn has_sent(&mut self) -> bool {
        self.serial.has_sent()
    }

    fn first_edge_us(&mut self) -> Option<u64> {
        // The hardware records only the lower half of the time, which is in the recent past.
        let now = self.now_us();
        self.serial.first_edge().map(|time| now - u64::from((now as u32).wrapping_sub(time)))
    }

    fn received_characters(&mut self) -> usize {
        self.serial.received()
    }

    fn received_character(&mut self, at: usize) -> u32 {
        self.serial.character(at)
    }

    fn end_transfer(&mut self) {
        self.serial.end();
    }

    fn start_conversions(&mut self) -> u64 {
        let timer = self.timer;
        self.is_converting = true;
        self.converter.start(|| timer.get_counter().ticks())
    }

    fn stop_conversions(&mut self) {
        self.is_converting = false;
        self.converter.stop();
    }

    fn converted(&self) -> u32 {
        self.converter.converted()
    }

    fn conversion(&self, number: u32) -> u16 {
        self.converter.value(number)
    }

    fn has_overrun(&self) -> bool {
        self.converter.has_overrun()
    }
}

/// Connects the clock pin to the state machines of a bus.
fn connect_clock(clocking: Clocking) {
    // Safety: only this function changes the function of the pin, which `Line` owns. Both machines keep the pin high.
    let bank = unsafe { &*IO_BANK0::ptr() };
    bank.gpio(CLOCK.into()).gpio_ctrl().modify(|_, w| match clocking {
        Clocking::Ssi(_) => w.funcsel().pio1(),
        Clocking::Biss(_) => w.funcsel().pio0(),
    });
}
