//! What a person fills in to connect an INTERBUS encoder, and the link it stands for. Nothing is opened here.

use super::target::{assemble, entered, filled, host_and_port, parted, refused};
use crate::app::Text;
use crate::device::interbus::PARAMETERS;
use crate::link::{LinkUrl, Scheme};
use crate::sim::interbus::Config;
use crate::worker::interbus::check;

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

impl InterbusForm {
    /// The virtual encoder as the window begins with it: a machine that turns slowly, with cams on its turn.
    pub fn usual() -> LinkUrl {
        let mut url = LinkUrl::sim();
        for (name, value) in [("rpm", "6"), ("steps", "3600"), ("revolutions", "1"), ("cams", "demo")] {
            url.query.set(name, value);
        }
        url
    }

    /// The form filled in as a link says.
    pub fn from_url(url: &LinkUrl) -> Self {
        let way = match url.scheme {
            Scheme::Sim => InterbusWay::Virtual,
            Scheme::Replay => InterbusWay::Replay,
            Scheme::Modbus | Scheme::Bridge | Scheme::Serial | Scheme::Tcp | Scheme::Enip => InterbusWay::Gateway,
        };
        let mut form = InterbusForm { way, ..InterbusForm::default() };
        match form.way {
            InterbusWay::Replay => form.file = url.target.clone(),
            InterbusWay::Gateway => {
                (form.host, form.tcp_port) = parted(&url.target);
                if form.tcp_port == PORT {
                    form.tcp_port.clear();
                }
            }
            InterbusWay::Virtual => {}
        }
        for (name, value) in url.query.pairs() {
            if (name.as_str(), value.as_str()) == LOW_FIRST {
                form.low_first = true;
                continue;
            }
            match form.entry(name) {
                Some(entry) => value.clone_into(entry),
                None => form.rest.push((name.clone(), value.clone())),
            }
        }
        form
    }

    /// The entry of a parameter; `None` where there is none.
    fn entry(&mut self, name: &str) -> Option<&mut String> {
        let is_virtual = self.way == InterbusWay::Virtual;
        match name {
            "unit" => Some(&mut self.unit),
            "input" => Some(&mut self.input),
            "output" => Some(&mut self.output),
            "handshake" => Some(&mut self.handshake),
            "rpm" if is_virtual => Some(&mut self.rpm),
            "fault" if is_virtual => Some(&mut self.fault),
            _ => None,
        }
    }

    /// The link that the entries stand for. What is as usual is left out.
    ///
    /// # Errors
    /// A sentence that says which entry cannot be used and what would be allowed.
    pub fn url(&self) -> Result<LinkUrl, Text> {
        let (scheme, target) = self.target()?;
        let url = assemble(scheme, &target, &self.parameters())?;
        check(&url).map_err(|error| refused(&url, &error))?;
        Ok(url)
    }

    fn target(&self) -> Result<(Scheme, String), Text> {
        Ok(match self.way {
            InterbusWay::Virtual => (Scheme::Sim, String::new()),
            InterbusWay::Gateway => {
                let port = filled(&self.tcp_port).unwrap_or_else(|| PORT.to_owned());
                (Scheme::Modbus, host_and_port(&self.host, &port)?)
            }
            InterbusWay::Replay => (Scheme::Replay, entered(&self.file, "form.file_missing")?),
        })
    }

    fn parameters(&self) -> Vec<(String, String)> {
        let is_virtual = self.way == InterbusWay::Virtual;
        let mut parameters = Vec::new();
        let mut add = |name: &str, value: &str| {
            parameters.extend(filled(value).map(|value| (name.to_owned(), value)));
        };
        if is_virtual {
            // A German keyboard has a comma where the point should be.
            add("rpm", &self.rpm.replace(',', "."));
            add("fault", &self.fault);
        }
        add("unit", &self.unit);
        add("input", &self.input);
        add("output", &self.output);
        add("handshake", &self.handshake);
        if self.low_first {
            add(LOW_FIRST.0, LOW_FIRST.1);
        }
        // What only a virtual encoder has is not taken along.
        let belongs = |name: &str| is_virtual || PARAMETERS.contains(&name) || !Config::KEYS.contains(&name);
        for (name, value) in self.rest.iter().filter(|(name, _)| belongs(name)) {
            // What has an entry by now is what that says.
            if parameters.iter().all(|(own, _)| own != name) {
                parameters.push((name.clone(), value.clone()));
            }
        }
        parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_is_shown_and_comes_back_as_it_was() {
        for link in [
            "sim:",
            "sim:?cams=demo&rpm=6",
            "sim:?rpm=-60&fault=drop:0.01&order=low-first&input=4",
            "modbus:gateway:502",
            "modbus:192.168.1.9:1502?unit=3&input=4&output=6&order=low-first&handshake=500",
            "replay:monday.trace",
        ] {
            let url: LinkUrl = link.parse().unwrap();
            let mut expected: Vec<_> = url.query.pairs().to_vec();
            let back = InterbusForm::from_url(&url).url().unwrap();
            let mut found: Vec<_> = back.query.pairs().to_vec();
            expected.sort();
            found.sort();
            assert_eq!((back.scheme, &back.target, found), (url.scheme, &url.target, expected), "{link}");
        }
    }

    #[test]
    fn what_cannot_be_is_refused_with_its_entry() {
        let refused = |change: fn(&mut InterbusForm)| {
            let mut form = InterbusForm::default();
            change(&mut form);
            form.url().unwrap_err().id()
        };
        assert_eq!(refused(|form| form.way = InterbusWay::Gateway), "form.host_missing");
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
