//! The analogue inputs. The ADC samples all five in turn at full speed, 2 µs per input, and the DMA copies the values.

use rp2040_hal as hal;

use hal::adc::AdcPin;
use hal::gpio::bank0::{Gpio26, Gpio27, Gpio28, Gpio29};
use hal::gpio::{FunctionNull, FunctionSio, Pin, PullDown, PullNone, SioInput};
use hal::pac::{ADC, RESETS};

use crate::ring::Ring;

/// Number of the DMA request signal of the ADC.
const REQUEST: u8 = 36;
/// Bit mask of all inputs: sine, cosine, supply voltage, board voltage and temperature.
const INPUTS: u8 = 0b1_1111;

/// A pin that is used as an ADC input, without pull-up and pull-down.
type Input<I> = AdcPin<Pin<I, FunctionSio<SioInput>, PullNone>>;

/// The ADC with its pins and the ring buffer for its values.
pub(crate) struct Converter {
    adc: ADC,
    ring: Ring,
    _pins: (Input<Gpio26>, Input<Gpio27>, Input<Gpio28>, Input<Gpio29>),
}

/// The pins before they are set up as inputs.
pub(crate) struct Pins {
    pub(crate) sine: Pin<Gpio26, FunctionNull, PullDown>,
    pub(crate) cosine: Pin<Gpio27, FunctionNull, PullDown>,
    pub(crate) supply: Pin<Gpio28, FunctionNull, PullDown>,
    pub(crate) board: Pin<Gpio29, FunctionNull, PullDown>,
}

impl Converter {
    /// Starts the converter. Returns `None` if a pin is in use.
    pub(crate) fn new(adc: ADC, ring: Ring, pins: Pins, resets: &mut RESETS) -> Option<Self> {
        let pins = (
            AdcPin::new(pins.sine.reconfigure()).ok()?,
            AdcPin::new(pins.cosine.reconfigure()).ok()?,
            AdcPin::new(pins.supply.reconfigure()).ok()?,
            AdcPin::new(pins.board.reconfigure()).ok()?,
        );
        let adc = hal::Adc::new(adc, resets).free();
        adc.cs().write(|w| w.en().set_bit().ts_en().set_bit());
        while adc.cs().read().ready().bit_is_clear() {}
        Some(Converter { adc, ring, _pins: pins })
    }

    /// Starts converting all inputs in turn, beginning with the sine. `now_us` reads the clock. Returns the start time.
    pub(crate) fn start(&mut self, now_us: impl Fn() -> u64) -> u64 {
        // Without a divisor, there is no pause between conversions.
        self.adc.div().reset();
        self.discard();
        // Safety: the threshold is one value, and the DMA serves the request.
        self.adc.fcs().write(|w| unsafe { w.en().set_bit().dreq_en().set_bit().thresh().bits(1) });
        self.ring.start(self.adc.fifo().as_ptr().cast_const(), REQUEST);
        // Safety: input 0 is the first input in the mask.
        let select = |w: &mut hal::pac::adc::cs::W| unsafe {
            w.en().set_bit().ts_en().set_bit().ainsel().bits(0).rrobin().bits(INPUTS);
        };
        self.adc.cs().write(|w| {
            select(w);
            w
        });
        critical_section::with(|_| {
            self.adc.cs().write(|w| {
                select(w);
                w.start_many().set_bit()
            });
            now_us()
        })
    }

    /// Ends the conversions.
    pub(crate) fn stop(&mut self) {
        self.adc.cs().write(|w| w.en().set_bit().ts_en().set_bit());
        while self.adc.cs().read().ready().bit_is_clear() {}
        self.ring.stop();
        self.discard();
    }

    /// Empties the FIFO, and clears its error flags by writing ones to them.
    fn discard(&mut self) {
        while self.adc.fcs().read().empty().bit_is_clear() {
            let _ = self.adc.fifo().read();
        }
        self.adc.fcs().write(|w| w.over().clear_bit_by_one().under().clear_bit_by_one());
    }

    /// Measures an input as the mean of sixteen values. Must only be called while no conversions are running.
    pub(crate) fn measure(&mut self, input: u32) -> u16 {
        let mut sum = 0_u32;
        for _ in 0..16 {
            // Safety: the number is a valid input.
            self.adc.cs().write(|w| unsafe {
                w.en().set_bit().ts_en().set_bit().ainsel().bits(input as u8).start_once().set_bit()
            });
            while self.adc.cs().read().ready().bit_is_clear() {}
            sum += u32::from(self.adc.result().read().result().bits());
        }
        // The mean has twelve bits.
        (sum / 16) as u16
    }

    /// Returns the number of conversions since the start, modulo 2³².
    pub(crate) fn converted(&self) -> u32 {
        self.ring.received()
    }

    /// Returns a value by its number.
    pub(crate) fn value(&self, number: u32) -> u16 {
        // The value has twelve bits.
        self.ring.value(number) as u16
    }

    /// Returns whether a conversion ended while the FIFO was full.
    pub(crate) fn has_overrun(&self) -> bool {
        self.adc.fcs().read().over().bit_is_set()
    }
}
