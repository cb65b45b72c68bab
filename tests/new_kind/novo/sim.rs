//! The virtual Novo encoder.

use encoder_studio::cli::ServableDevice;
use encoder_studio::expected::Quantity;
use encoder_studio::parameter::{OptionalValue, ParameterGroup, WholeNumbers};
use encoder_studio::parameters;
use encoder_studio::sim::{ByteDevice, ConfigError, RPM, VirtualDevice, setting};
use encoder_studio::units::Moment;

use super::protocol::{FIRST, POSITION, Request, SERIAL, TURN, Values, reply};

parameters! {
    /// The settings of a virtual encoder.
    struct Settings: ConfigError {
        serial: u16 = 1001, "serial" => WholeNumbers(Quantity::Number, 0..=65535);
        rpm: f64 = 0.0, "rpm" => RPM;
        /// Address of a value that can no longer be changed, if any.
        stuck: Option<u8> = None, "stuck" => OptionalValue(WholeNumbers(Quantity::Address, 0..=255));
        /// PIN that locks the encoder, so no value can be changed.
        pin: Option<u16> = None, secret "pin" => OptionalValue(WholeNumbers(Quantity::Number, 0..=9999));
    }
}

/// A virtual Novo encoder with a shaft that turns steadily. Its values are lost when it is dropped.
pub(crate) struct Virtual {
    settings: Settings,
    values: Values,
    asked: Vec<u8>,
    answers: Vec<u8>,
}

impl Virtual {
    /// Names of the settings whose values are neither shown nor stored.
    pub(crate) const SECRETS: &'static [&'static str] = Settings::SECRETS;

    /// Parses the query part of a link.
    pub(crate) fn from_pairs(pairs: &[(String, String)]) -> Result<Self, ConfigError> {
        let settings = setting::read(VirtualDevice::EncoderOf("Novo"), pairs)?;
        Ok(Virtual { settings, values: [0, 3, 0, 65535], asked: vec![], answers: vec![] })
    }
    fn word(&self, now: Moment, address: u8) -> u16 {
        let [zero, ..] = self.values;
        match address {
            SERIAL => self.settings.serial,
            POSITION => {
                let steps = now.since_start().as_secs_f64() * self.settings.rpm / 60.0 * f64::from(TURN);
                (steps.floor() as i64 as u16).wrapping_sub(zero)
            }
            _ => self.values.get(usize::from(address.wrapping_sub(FIRST))).copied().unwrap_or(0),
        }
    }
}

impl ByteDevice for Virtual {
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]) {
        self.asked.extend(bytes);
        let Some(request) = Request::parse(&self.asked) else { return };
        self.asked.clear();
        let address = match request {
            Request::Read(address) => address,
            Request::Write(address, word) => {
                let kept = self.values.get_mut(usize::from(address.wrapping_sub(FIRST)));
                if let Some(value) =
                    kept.filter(|_| self.settings.stuck != Some(address) && self.settings.pin.is_none())
                {
                    *value = word;
                }
                address
            }
        };
        self.answers.extend(reply(request, self.word(now, address)));
    }
    fn poll(&mut self, _now: Moment) -> Vec<u8> {
        std::mem::take(&mut self.answers)
    }
    fn poll_at(&self) -> Option<Moment> {
        (!self.answers.is_empty()).then_some(Moment::START)
    }
    fn connect(&mut self, _now: Moment) {
        (self.asked, self.answers) = (vec![], vec![]);
    }
}

impl ServableDevice for Virtual {}
