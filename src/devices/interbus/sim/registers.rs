//! Process data in Modbus registers. Each encoder has two input registers for its IN word and two holding registers for
//! its OUT word. Any read or write of these registers is one cycle of its process data. The word of a K1 encoder is
//! only 16 bits long and is in the lower register.

use super::config::Config;
use super::encoder::Encoder;
use super::frame::Exception;
use crate::devices::interbus::protocol::WordOrder;
use crate::units::Moment;

#[derive(Clone, Copy, Debug)]
pub(super) struct RegisterMap {
    input: u16,
    output: u16,
    order: WordOrder,
}

/// Encoders, in the order of their registers.
#[derive(Debug)]
pub(super) struct EncoderList {
    pub(super) first: Encoder,
    others: Vec<Encoder>,
}

/// Number of registers per word.
const REGISTERS: usize = 2;

type Result<T> = std::result::Result<T, Exception>;

impl EncoderList {
    pub(super) fn new(config: &Config) -> Self {
        let others = (1..config.encoders).map(|number| Encoder::new(config, number)).collect();
        EncoderList { first: Encoder::new(config, 0), others }
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Encoder> {
        std::iter::once(&mut self.first).chain(&mut self.others)
    }

    fn registers(&self) -> usize {
        (1 + self.others.len()) * REGISTERS
    }
}

impl RegisterMap {
    pub(super) const fn new(config: &Config) -> Self {
        RegisterMap { input: config.input, output: config.output, order: config.order }
    }

    /// Reads IN words with function 4.
    pub(super) fn inputs(&self, encoders: &mut EncoderList, now: Moment, first: u16, count: u16) -> Result<Vec<u16>> {
        self.read(encoders, self.input, first, count, |encoder| encoder.read(now).ok_or(Exception::NoAnswer))
    }

    /// Reads the present OUT words with function 3.
    pub(super) fn outputs(&self, encoders: &mut EncoderList, first: u16, count: u16) -> Result<Vec<u16>> {
        self.read(encoders, self.output, first, count, |encoder| Ok(encoder.out_word()))
    }

    /// Writes complete OUT words with function 16, or halves of them with function 6 or 16.
    pub(super) fn write(&self, encoders: &mut EncoderList, now: Moment, first: u16, values: &[u16]) -> Result<()> {
        let begin = self.register_offset(encoders, self.output, first, values.len())?;
        let places = begin..begin + values.len();
        for (encoder, own) in encoders.iter_mut().zip((0..).step_by(REGISTERS)) {
            let mut halves = self.order.registers(encoder.out_word());
            let written = halves.iter_mut().zip(own..).filter(|(_, place)| places.contains(place));
            let mut written_to = false;
            for (half, place) in written {
                *half = values.get(place - begin).copied().unwrap_or(*half);
                written_to = true;
            }
            if written_to && encoder.has_power() {
                encoder.write(now, self.order.combine(halves));
            } else if written_to {
                return Err(Exception::NoAnswer);
            }
        }
        Ok(())
    }

    fn read(
        &self,
        encoders: &mut EncoderList,
        base: u16,
        first: u16,
        count: u16,
        mut word: impl FnMut(&mut Encoder) -> Result<u32>,
    ) -> Result<Vec<u16>> {
        let begin = self.register_offset(encoders, base, first, usize::from(count))?;
        let places = begin..begin + usize::from(count);
        let mut registers = Vec::new();
        for (encoder, own) in encoders.iter_mut().zip((0..).step_by(REGISTERS)) {
            if own < places.end && own + REGISTERS > places.start {
                let halves = self.order.registers(word(encoder)?);
                let requested = halves.into_iter().zip(own..).filter(|(_, place)| places.contains(place));
                registers.extend(requested.map(|(half, _)| half));
            }
        }
        Ok(registers)
    }

    /// Returns the offset of a register from the first encoder's register. Returns an exception unless all requested
    /// registers exist.
    fn register_offset(&self, encoders: &EncoderList, base: u16, first: u16, count: usize) -> Result<usize> {
        let begin = first.checked_sub(base).map(usize::from).ok_or(Exception::Address)?;
        if begin + count <= encoders.registers() { Ok(begin) } else { Err(Exception::Address) }
    }
}
