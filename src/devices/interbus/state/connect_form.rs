//! What a person fills in to connect an INTERBUS encoder, and the link it stands for. Nothing is opened here.

use crate::app::Text;
use crate::app::connect::form::{FormModel, NoFinder};
use crate::app::connect::parameters::{Parameters, without_entry};
use crate::app::connect::target::{checked, entered, host_and_usual_port, parted_from_usual};
use crate::devices::interbus::jobs::check;
use crate::devices::interbus::procedures::LinkParameters;
use crate::devices::interbus::sim::Config;
use crate::link::{LinkUrl, Scheme};

/// How the encoder is reached.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InterbusWay {
    /// The virtual encoder in this program, behind a virtual gateway.
    #[default]
    Virtual,
    /// A Modbus/TCP gateway.
    Gateway,
    /// A recorded trace.
    Replay,
}

/// The entries of the connection form. Entries of another way are kept and left out of the link. An empty entry stands
/// for what is usual.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InterbusForm {
    /// How the encoder is reached.
    pub way: InterbusWay,
    /// Name or address of the gateway.
    pub host: String,
    /// Its TCP port; empty: 502.
    pub tcp_port: String,
    /// The recording.
    pub file: String,
    /// The gateway's unit; empty: 1.
    pub unit: String,
    /// The first input register of the IN word; empty: 0.
    pub input: String,
    /// The first holding register of the OUT word; empty: 0.
    pub output: String,
    /// The low word of the two comes first.
    pub low_first: bool,
    /// Milliseconds until an echo has to stand.
    pub handshake: String,
    /// The virtual encoder's speed in revolutions a minute.
    pub rpm: String,
    /// What goes wrong with it on purpose.
    pub fault: String,
    /// Parameters of the link that have no entry.
    pub rest: Vec<(String, String)>,
}

/// The parameter for the order of the two words, and the order that is not usual.
const LOW_FIRST: (&str, &str) = ("order", "low-first");
/// The port of Modbus/TCP.
const PORT: &str = "502";

impl FormModel for InterbusForm {
    type Finder = NoFinder<Self>;

    // The virtual encoder as the window begins with it: a machine that turns slowly, with cams on its turn.
    fn usual() -> LinkUrl {
        let mut url = LinkUrl::sim();
        for (name, value) in [("rpm", "6"), ("steps", "3600"), ("revolutions", "1"), ("cams", "demo")] {
            url.query.set(name, value);
        }
        url
    }

    fn from_url(url: &LinkUrl) -> Self {
        let way = match url.scheme {
            Scheme::Sim => InterbusWay::Virtual,
            Scheme::Replay => InterbusWay::Replay,
            Scheme::Modbus | Scheme::Bridge | Scheme::Serial | Scheme::Tcp | Scheme::Enip => InterbusWay::Gateway,
        };
        let mut form = InterbusForm { way, ..InterbusForm::default() };
        match form.way {
            InterbusWay::Replay => form.file = url.target.clone(),
            InterbusWay::Gateway => (form.host, form.tcp_port) = parted_from_usual(&url.target, PORT),
            InterbusWay::Virtual => {}
        }
        form.rest = without_entry(&url.query, |name, value| form.take(name, value));
        form
    }

    fn url(&self) -> Result<LinkUrl, Text> {
        checked(self.parameters().link(self.target()?)?, check)
    }

    fn set_file(&mut self, file: String) {
        self.file = file;
    }

    fn example(&self) -> &'static str {
        "modbus:192.168.1.10"
    }
}

impl InterbusForm {
    /// Fills in the entry of a parameter; false where there is none that can show it.
    fn take(&mut self, name: &str, value: &str) -> bool {
        let is_virtual = self.way == InterbusWay::Virtual;
        let entry = match name {
            "unit" => &mut self.unit,
            "input" => &mut self.input,
            "output" => &mut self.output,
            "handshake" => &mut self.handshake,
            "rpm" if is_virtual => &mut self.rpm,
            "fault" if is_virtual => &mut self.fault,
            _ => {
                self.low_first |= (name, value) == LOW_FIRST;
                return (name, value) == LOW_FIRST;
            }
        };
        value.clone_into(entry);
        true
    }

    fn target(&self) -> Result<(Scheme, String), Text> {
        Ok(match self.way {
            InterbusWay::Virtual => (Scheme::Sim, String::new()),
            InterbusWay::Gateway => {
                (Scheme::Modbus, host_and_usual_port(&self.host, "form.gateway_missing", &self.tcp_port, PORT)?)
            }
            InterbusWay::Replay => (Scheme::Replay, entered(&self.file, "form.file_missing")?),
        })
    }

    fn parameters(&self) -> Parameters {
        let is_virtual = self.way == InterbusWay::Virtual;
        let mut parameters = Parameters::default();
        if is_virtual {
            parameters.decimal("rpm", &self.rpm);
            parameters.entry("fault", &self.fault);
        }
        parameters.entry("unit", &self.unit);
        parameters.entry("input", &self.input);
        parameters.entry("output", &self.output);
        parameters.entry("handshake", &self.handshake);
        if self.low_first {
            parameters.set(LOW_FIRST.0, LOW_FIRST.1);
        }
        // What only a virtual encoder has is not taken along.
        let belongs = |name: &str| is_virtual || LinkParameters::KEYS.contains(&name) || !Config::KEYS.contains(&name);
        parameters.rest(&self.rest, belongs);
        parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::connect::parameters::tests::assert_comes_back;

    #[test]
    fn a_link_is_shown_and_comes_back_as_it_was() {
        let links = [
            "sim:",
            "sim:?cams=demo&rpm=6",
            "sim:?rpm=-60&fault=drop:0.01&order=low-first&input=4",
            "modbus:gateway:502",
            "modbus:192.168.1.9:1502?unit=3&input=4&output=6&order=low-first&handshake=500",
            "replay:monday.trace",
        ];
        assert_comes_back(&links, |url| InterbusForm::from_url(url).url());
    }

    #[test]
    fn what_cannot_be_is_refused_with_its_entry() {
        let refused = |change: fn(&mut InterbusForm)| {
            let mut form = InterbusForm::default();
            change(&mut form);
            form.url().unwrap_err().id()
        };
        assert_eq!(refused(|form| form.way = InterbusWay::Gateway), "form.gateway_missing");
        assert_eq!(refused(|form| form.way = InterbusWay::Replay), "form.file_missing");
        assert_eq!(refused(|form| form.rpm = "fast".to_owned()), "form.rpm");
        assert_eq!(refused(|form| form.fault = "drop:2".to_owned()), "form.fault");
        assert_eq!(refused(|form| form.unit = "300".to_owned()), "form.parameter");
        assert_eq!(refused(|form| form.input = "x".to_owned()), "form.parameter");
    }

    #[test]
    fn another_way_takes_along_only_what_it_has() {
        let mut form = InterbusForm::from_url(&"sim:?rpm=60&busy=5&unit=7".parse().unwrap());
        (form.way, form.host) = (InterbusWay::Gateway, "gate".to_owned());
        assert_eq!(form.url().unwrap().to_string(), "modbus:gate:502?unit=7");
    }
}
