//! Test support for the state of the window: a studio in its own environment, with two cables and a link that hangs
//! forever.

use crate::tabs::Tabs as _;
use encoder_studio::app::{DeviceCommand, DeviceModel as _};
use encoder_studio::app::{LinkOpener, TypeMap};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use encoder_studio::app::review::Permit;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, GracePeriods, ReviewAction, Severity, Studio, StudioEnvironment, connect};
use encoder_studio::devices::biss::jobs as biss;
use encoder_studio::devices::biss::procedures::Transport;
use encoder_studio::devices::hiperdrive::jobs as hiperdrive;
use encoder_studio::devices::hiperdrive::procedures::DiscoveredDevice;
use encoder_studio::devices::hiperdrive::state::DiscoveryStub;
use encoder_studio::devices::hiperface::procedures::Station;
use encoder_studio::devices::hiperface::profile::{Base, HiperfacePlan};
use encoder_studio::devices::hiperface::protocol::EncoderTypes;
use encoder_studio::devices::hiperface::state::{Encoder, HiperfaceAction as Hiperface, Review, ReviewState};
use encoder_studio::devices::interbus::jobs as interbus;
use encoder_studio::kinds::{Program, program};
use encoder_studio::link::{ByteLink, LinkError, LinkErrorKind, LinkScheme, LinkUrl};
use encoder_studio::store::{BaseFolders, Store};
use encoder_studio::worker::Session;

use crate::novo::jobs::Novo;
use crate::texts;
use crate::wire::{TestLink, Wire};

/// A time limit longer than any test, to detect a hanging thread.
pub(crate) const LONG: Duration = Duration::from_secs(20);
/// The reply margin of `sim:` links.
pub(crate) const MARGIN: Duration = Duration::from_millis(20);

/// The environment of a test: a folder and the devices to which links connect.
pub(crate) struct Outside {
    pub(crate) folder: tempfile::TempDir,
    wires: BTreeMap<String, Arc<Wire>>,
    pub(crate) wakes: Arc<AtomicUsize>,
    /// Whether links to [`SLOW`] open.
    pub(crate) opens: Arc<AtomicBool>,
    pub(crate) patience: GracePeriods,
    /// The devices that reply to a discovery request on the network.
    pub(crate) found: Vec<DiscoveredDevice>,
    /// The program with its device kinds.
    pub(crate) program: Program,
}

/// The port of the encoder that `begin` finds. The link `sim:` leads to it as well.
pub(crate) const PORT: &str = "/dev/enc0";
/// A port with another encoder.
pub(crate) const OTHER_PORT: &str = "/dev/enc1";
/// A link that never opens.
pub(crate) const HANGING_LINK: &str = "tcp:hanging:1";
/// A link to the encoder at [`PORT`] that opens only on command. With another address, it opens immediately.
pub(crate) const SLOW: &str = "tcp:slow:1";

/// The port of a BiSS encoder's configuration pin.
pub(crate) const KIT: &str = "/dev/kit0";
/// The port of an adapter on the bus of another BiSS encoder.
pub(crate) const ADAPTER: &str = "/dev/adapter0";
/// The address of a gateway to an INTERBUS encoder.
pub(crate) const GATE: &str = "gate:502";
/// The address of an adapter with a HIPERDRIVE drive.
pub(crate) const DRIVE: &str = "drive:44818";
/// A port with an encoder of the test kind.
pub(crate) const NOVO_PORT: &str = "/dev/novo0";
/// Device servers in front of [`PORT`], [`KIT`] and [`ADAPTER`], as named in links.
pub(crate) const SERVERS: [(&str, &str); 3] = [("moxa:4001", PORT), ("moxa:4002", KIT), ("tcp:adapter:5000", ADAPTER)];

impl Outside {
    /// Creates encoders at [`PORT`] as described by `query`, an SKS36 at [`OTHER_PORT`], and kit encoders at [`KIT`]
    /// and behind [`ADAPTER`].
    pub(crate) fn new(query: &str) -> Self {
        let wires = [
            Wire::new(PORT, query),
            Wire::new(OTHER_PORT, "model=sks36"),
            Wire::to_pin(KIT, ""),
            Wire::to_adapter(ADAPTER, ""),
            Wire::to_target(DRIVE, ""),
            Wire::to_novo(NOVO_PORT, ""),
            Wire::to_gateway(GATE, "steps=3600&revolutions=1&cams=demo"),
        ];
        let mut wires: BTreeMap<String, Arc<Wire>> =
            wires.into_iter().map(|wire| (wire.target().to_owned(), wire)).collect();
        for (server, port) in SERVERS {
            wires.insert(server.to_owned(), wires[port].clone());
        }
        let (wakes, opens, patience) = (Arc::default(), Arc::default(), GracePeriods::default());
        Outside {
            folder: tempfile::tempdir().unwrap(),
            wires,
            wakes,
            opens,
            patience,
            found: Vec::new(),
            program: program(),
        }
    }

    pub(crate) fn store(&self) -> Store {
        Store::at_root(self.folder.path())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn wire(&self, port: &str) -> &Arc<Wire> {
        &self.wires[port]
    }

    pub(crate) fn world(&self) -> StudioEnvironment {
        let (wires, opens, found) = (self.wires.clone(), self.opens.clone(), self.found.clone());
        let (kits, gates, drives) = (self.wires.clone(), self.wires.clone(), self.wires.clone());
        let novos = self.wires.clone();
        StudioEnvironment {
            given: TypeMap::default()
                .with_value(LinkOpener::new(move |url, store| {
                    let Some(wire) = kits.get(&url.target) else { return biss::open(url, store) };
                    let way = if url.scheme == LinkScheme::Bridge { Transport::Adapter } else { Transport::ConfigPin };
                    let station =
                        encoder_studio::devices::biss::procedures::Station::from_query(&url.query, way, MARGIN)?;
                    let link = Box::new(TestLink::plug_into(wire)?);
                    Ok(Session::from_connection(link, wire.clock(), station, store, None))
                }))
                .with_value(LinkOpener::new(move |url, store| {
                    let Some(wire) = gates.get(&url.target) else { return interbus::open(url, store) };
                    let station =
                        encoder_studio::devices::interbus::procedures::Station::from_query(&url.query, MARGIN)?;
                    Ok(Session::for_gateway(Box::new(TestLink::plug_into(wire)?), wire.clock(), station, store, None))
                }))
                .with_value(LinkOpener::new(move |url, store| {
                    if url.scheme == LinkScheme::Sim {
                        return crate::unhurried::open(url, store);
                    }
                    let Some(wire) = drives.get(&url.target) else { return hiperdrive::open(url, store) };
                    let station =
                        encoder_studio::devices::hiperdrive::procedures::Station::from_query(&url.query, None, MARGIN)?;
                    let link = Box::new(TestLink::plug_into(wire)?);
                    let way = hiperdrive::DeviceConnection { wire: link, port: None, station, target: None };
                    Ok(Session::for_target(way, wire.clock(), store))
                }))
                .with_value(LinkOpener::new(move |url, store| {
                    let Some(wire) = novos.get(&url.target) else { return crate::novo::jobs::open(url, store) };
                    Ok(Session::from_device(Novo(Box::new(TestLink::plug_into(wire)?)), wire.clock(), store, false))
                }))
                .with_value(LinkOpener::new(move |url, store| {
                    if url.to_string() == HANGING_LINK {
                        loop {
                            std::thread::park();
                        }
                    }
                    while url.to_string() == SLOW && !opens.load(Ordering::SeqCst) {
                        std::thread::sleep(Duration::from_millis(1));
                    }
                    let leads_to_port = url.scheme == LinkScheme::Sim || url.target == SLOW.trim_start_matches("tcp:");
                    let target = if leads_to_port { PORT } else { &url.target };
                    let wire = wires.get(target).ok_or_else(|| LinkError::new(target, LinkErrorKind::NotFound))?;
                    let station = Station::from_query(&url.query, MARGIN)?;
                    let mut link = TestLink::plug_into(wire)?;
                    link.set_format(station.format)?;
                    let is_virtual = url.scheme == LinkScheme::Sim;
                    Ok(Session::new(Box::new(link), wire.clock(), station, store, EncoderTypes::built_in(), is_virtual))
                }))
                .with_value(DiscoveryStub::new(move || Ok(found.clone()))),
            ports: Arc::new(|| Ok(Vec::new())),
            patience: self.patience,
            folders: BaseFolders::with_base_folders(&self.path("work"), &self.path("home"))
                .with_program_folder(&self.path("program/bin")),
            ..StudioEnvironment::production(self.store(), self.program.studio)
        }
    }

    /// Creates a studio that does not start live values by itself, so a test knows what is sent on the line.
    pub(crate) fn studio(&self) -> Studio {
        let mut studio = self.usual_studio();
        studio.settings.live_stopped = true;
        studio
    }

    /// Creates a studio with the default settings of the program.
    pub(crate) fn usual_studio(&self) -> Studio {
        let wakes = self.wakes.clone();
        let wake = move || {
            wakes.fetch_add(1, Ordering::SeqCst);
        };
        Studio::new(self.world(), Arc::new(wake))
    }
}

/// A studio with its environment.
pub(crate) struct Desk {
    pub(crate) studio: Studio,
    pub(crate) outside: Outside,
}

impl Desk {
    /// Returns the number of recorded positions without a valid value.
    pub(crate) fn bad_positions(&self) -> u64 {
        let recorder = &self.encoder().recording().recorder();
        let history = recorder.history(&recorder.series()[0]).unwrap();
        history.statistics(0, history.indices()).map_or(0, |statistics| statistics.bad)
    }

    /// Creates a studio that has not been started.
    pub(crate) fn fresh(query: &str) -> Self {
        let outside = Outside::new(query);
        Desk { studio: outside.studio(), outside }
    }

    /// Creates a studio with the test kind that has not been started.
    pub(crate) fn with_novo() -> Self {
        let outside = Outside { program: crate::tabs::with_novo(), ..Outside::new("") };
        Desk { studio: outside.studio(), outside }
    }

    /// Creates a studio with short timeouts for closing. It is connected to an encoder at [`PORT`] that has been read.
    pub(crate) fn impatient(query: &str) -> Self {
        let mut outside = Outside::new(query);
        let milliseconds = Duration::from_millis;
        outside.patience = GracePeriods {
            drives: milliseconds(50),
            disk: milliseconds(50),
            job: milliseconds(100),
            write: milliseconds(1_500),
        };
        let mut desk = Desk { studio: outside.studio(), outside };
        desk.open(&format!("serial:{PORT}"));
        desk.until_read();
        desk
    }

    /// Creates a studio connected to the virtual encoder, which has been read.
    pub(crate) fn new_form(query: &str) -> Self {
        let mut desk = Self::fresh(query);
        desk.studio.start_with(None, None);
        desk.until_read();
        desk
    }

    /// Creates a studio connected to the encoder at [`PORT`], which has been read.
    pub(crate) fn connected_at_port(query: &str) -> Self {
        let mut desk = Self::fresh(query);
        desk.open(&format!("serial:{PORT}"));
        desk.until_read();
        desk
    }

    /// Drops the studio without closing it and starts it again in the same environment.
    pub(crate) fn crash(self) -> Self {
        let Desk { studio, outside } = self;
        drop(studio);
        Desk { studio: outside.studio(), outside }
    }

    pub(crate) fn wire(&self) -> Arc<Wire> {
        self.outside.wire(PORT).clone()
    }

    pub(crate) fn open(&mut self, link: &str) {
        self.studio.start_with(Some(link.parse::<LinkUrl>().unwrap()), None);
        only_master(&mut self.studio);
    }

    pub(crate) fn act(&mut self, action: Action) {
        let began = Instant::now();
        self.studio.handle_action(action);
        only_master(&mut self.studio);
        assert!(began.elapsed() < LONG, "an action made the window wait");
    }

    pub(crate) fn ask(&mut self, action: Hiperface) {
        let shown = self.studio.hiperface().map(|encoder| encoder.session.id);
        if let Some(id) = shown {
            self.act(Action::device(id, action));
        }
    }

    pub(crate) fn command(&mut self, command: DeviceCommand) {
        let shown = self.studio.hiperface().map(|encoder| encoder.session.id);
        if let Some(id) = shown {
            self.act(Action::Command(id, command));
        }
    }

    pub(crate) fn connect(&mut self, action: connect::ConnectAction) {
        self.act(Action::Connect(action));
    }

    /// Polls until the condition holds.
    #[track_caller]
    pub(crate) fn until(&mut self, what: &str, condition: impl Fn(&Studio) -> bool) {
        let began = Instant::now();
        loop {
            self.studio.poll();
            texts::check_all(&self.studio);
            if condition(&self.studio) {
                return;
            }
            if began.elapsed() > LONG {
                panic!("never: {what}\n{}", log(&self.studio));
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Polls until the selected encoder has been read and nothing is running.
    #[track_caller]
    pub(crate) fn until_read(&mut self) {
        self.until("the encoder is read", |studio| {
            studio.hiperface().is_some_and(|encoder| encoder.session.is_ready() && encoder.identity.is_some())
        });
        self.settle();
    }

    /// Polls until the selected encoder is ready for the next job.
    #[track_caller]
    pub(crate) fn until_ready(&mut self) {
        self.until("ready", |studio| studio.hiperface().is_some_and(|own| own.session.is_ready()));
    }

    /// Waits for the results of tasks on threads, such as drafts, lists and settings.
    pub(crate) fn settle(&mut self) {
        for _ in 0..30 {
            self.studio.poll();
            std::thread::sleep(Duration::from_millis(1));
        }
        texts::check_all(&self.studio);
    }

    /// Polls until the edits of the selected device are on disk.
    #[track_caller]
    pub(crate) fn until_kept(&mut self) {
        let folder = self.outside.path("data/drafts");
        self.until("the edits are kept", |studio| {
            let edits: Vec<(u8, usize, u8)> = studio.hiperface().unwrap().staged.edited_bytes().collect();
            let kinds = std::fs::read_dir(&folder).into_iter().flatten();
            let files = kinds.flat_map(|kind| std::fs::read_dir(kind.unwrap().path()).unwrap());
            // A temporary file that is to replace the draft may be in the same folder.
            let files =
                files.map(|file| file.unwrap().path()).filter(|path| path.extension().is_some_and(|own| own == "ron"));
            let texts = files.filter_map(|path| std::fs::read_to_string(path).ok());
            texts.filter_map(|text| ron::from_str(&text).ok()).any(|kept: Vec<(u8, usize, u8)>| kept == edits)
        });
    }

    pub(crate) fn encoder(&self) -> &Encoder {
        self.studio.hiperface().expect("an encoder is shown")
    }

    pub(crate) fn review(&self) -> &Review {
        self.encoder().session.review.as_ref().expect("a review is open")
    }

    pub(crate) fn phase(&self) -> &Phase {
        &self.encoder().session.phase
    }

    pub(crate) fn put(&mut self, field: u8, address: usize, bytes: &[u8]) {
        self.ask(Hiperface::Put { field, address, bytes: bytes.to_vec() });
    }

    /// Returns the edits, each as field, address and byte.
    pub(crate) fn edits(&self) -> Vec<(u8, usize, u8)> {
        self.encoder().staged.edited_bytes().collect()
    }

    /// Polls until the plan is ready.
    #[track_caller]
    pub(crate) fn until_planned(&mut self) {
        self.until("the plan is ready", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
        self.until_ready();
    }

    /// Polls until the plan has been written and read back.
    #[track_caller]
    pub(crate) fn until_written(&mut self) {
        self.until("it is written", |studio| is_review(studio, |state| matches!(state, ReviewState::Done(..))));
        self.until_ready();
        self.settle();
    }

    /// Consents to the plan in the review.
    pub(crate) fn write_as_shown(&mut self) {
        let nothing = HiperfacePlan { base: Base::default(), ops: Vec::new() };
        let shown = self.encoder().session.review.as_ref().and_then(Review::prepared_plan);
        let id = shown.map_or(nothing.id(), |prepared| prepared.plan.id());
        self.ask(Hiperface::Write(id));
    }

    /// Toggles a permission in the review.
    pub(crate) fn toggle(&mut self, permit: Permit) {
        let session = self.encoder().session.id;
        self.act(Action::Review(session, ReviewAction::Toggle(permit)));
    }

    /// Reviews and writes the edits.
    #[track_caller]
    pub(crate) fn write(&mut self) {
        self.command(DeviceCommand::Review);
        self.until_planned();
        self.write_as_shown();
        self.until_written();
    }

    /// Returns the text IDs in all notices of at least the given severity.
    pub(crate) fn notice_ids(&self, least: Severity) -> Vec<&'static str> {
        let notices = self.studio.services.log.notices().filter(|notice| notice.severity >= least);
        notices.flat_map(|notice| notice.texts.iter().map(encoder_studio::app::Text::id)).collect()
    }

    /// Returns how often a text was reported.
    pub(crate) fn notice_count(&self, id: &str) -> usize {
        self.notice_ids(Severity::Note).iter().filter(|own| **own == id).count()
    }
}

/// Confirms that no drive is on the line, if asked. These tests have no drive; the question itself is tested in
/// `connecting`.
pub(crate) fn only_master(studio: &mut Studio) {
    if asks_for_drive(studio) {
        studio.handle_action(Action::Confirm);
    }
}

/// Returns whether the program is asking about a drive on the line.
pub(crate) fn asks_for_drive(studio: &Studio) -> bool {
    studio.question.as_ref().is_some_and(|question| question.text.id() == "question.drive")
}

pub(crate) fn is_review(studio: &Studio, wanted: impl Fn(&ReviewState) -> bool) -> bool {
    studio.hiperface().and_then(|encoder| encoder.session.review.as_ref()).is_some_and(|review| wanted(&review.state))
}

/// Returns all messages for the output of a failed test.
pub(crate) fn log(studio: &Studio) -> String {
    let words = |notice: &encoder_studio::app::Notice| {
        let words: Vec<String> = notice.texts.iter().map(encoder_studio::app::Text::terminal_text).collect();
        format!("{:?} {:?} {}", notice.severity, notice.about, words.join(" "))
    };
    studio.services.log.notices().map(words).collect::<Vec<_>>().join("\n")
}
