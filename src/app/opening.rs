//! Opening of links. A link is opened on a thread as soon as the connection is free. If a session already uses the
//! connection, that session opens the link.

use crossbeam_channel::{Receiver, Sender, bounded};

use super::action::{Action, ConnectAttempt, OpenFailure, OpenedConnection, TaskResult};
use super::question::{FollowUpAction, Question};
use super::services::{JobState, Services, StudioEnvironment};
use super::session::{Kind, PendingOpen, Phase, Source};
use super::shutdown::is_same_connection;
use super::studio::{SessionId, Studio};
use super::tab::Tab;
use super::tasks::WakeCallback;
use super::type_map::LinkOpener;
use super::{AnyDevice, Severity, Text};
use crate::link::{LinkScheme, LinkUrl, TraceEntry, UrlError};
use crate::worker::{OpenError, Ring, Session, Worker};

/// Maximum number of trace frames that wait for the window, enough for ten seconds at 2,000 frames per second.
const FRAMES: usize = 20_000;
/// Maximum memory for waiting trace frames, in bytes.
const FRAME_BYTES: usize = 8 << 20;

impl Studio {
    /// Returns the tab of the kind of device to which a link refers.
    ///
    /// If several kinds of devices are possible, a tab in which the link has been used takes precedence, followed by
    /// kinds of devices for which such links are usual. Among equal candidates, the open tab comes first. Without a
    /// link, the open tab is returned.
    pub(super) fn tab_for_link(&self, link: Option<&LinkUrl>) -> Tab {
        let kinds = self.services.world.kinds;
        let tab = self.settings.tab;
        let shown = if kinds.kind_for_tab(tab).is_some() { tab } else { kinds.first_tab() };
        let Some(link) = link else { return shown };
        let fits = |tab: &Tab| kinds.kind_for_tab(*tab).is_some_and(|kind| kind.check_link(link).is_ok());
        // Every kind has virtual devices, so a `sim:` link does not identify the kind.
        let text = (link.scheme != LinkScheme::Sim).then(|| link.to_string());
        let used =
            |tab: &Tab| fits(tab) && text.as_ref().is_some_and(|text| self.settings.links_of(*tab).contains(text));
        let tabs = || std::iter::once(shown).chain(kinds.devices().iter().map(|kind| kind.tab()));
        let is_elsewhere = |error| matches!(error, OpenError::Url(UrlError::Device { .. }));
        let leads_there =
            |tab: &Tab| kinds.kind_for_tab(*tab).is_some_and(|kind| !kind.check_link(link).is_err_and(is_elsewhere));
        let is_usual = |tab: &Tab| kinds.kind_for_tab(*tab).is_some_and(|kind| kind.is_typical_link(link));
        let find = |fits: &dyn Fn(&Tab) -> bool| {
            tabs().find(|tab| is_usual(tab) && fits(tab)).or_else(|| tabs().find(|tab| fits(tab)))
        };
        // An invalid link is reported by a kind of device that uses links with this scheme.
        tabs().find(used).or_else(|| find(&fits)).or_else(|| find(&leads_there)).unwrap_or(shown)
    }

    /// Opens a link to a kind of device. A session of this kind that uses the connection is reused. A session of
    /// another kind is released.
    pub(super) fn open_link(&mut self, tab: Tab, url: LinkUrl) {
        let url = self.with_absolute_file(url);
        if let Some(id) = self.prepare_session_for_link(tab, &url) {
            self.open_session_link(id, url);
        }
    }

    /// Opens a link to a device that was found by a search. The search has already asked about other masters on the
    /// line.
    pub(super) fn open_discovered(&mut self, tab: Tab, url: LinkUrl) {
        let was_asked =
            self.services.world.kinds.kind_for_tab(tab).is_some_and(|kind| kind.may_have_other_master(&url));
        if let Some(id) = self.prepare_session_for_link(tab, &url) {
            self.start_open_attempt(id, url, was_asked);
        }
    }

    /// Selects or creates the session for a link. Returns `None` if the link must not be opened.
    fn prepare_session_for_link(&mut self, tab: Tab, url: &LinkUrl) -> Option<SessionId> {
        let mut own = None;
        for device in &mut self.devices {
            let holds = matches!(device.source(), Source::Link(other) if is_same_connection(other, url));
            if !holds {
                continue;
            }
            if device.is_writing() {
                self.services.notify(Severity::Warning, vec![Text::new("session.busy")], Some(&device.name()));
                let (tab, id) = (device.tab(), device.id());
                self.show(tab, id);
                return None;
            }
            let held = device.is_connected();
            device.release_thread(JobState::Cancelled, &mut self.services);
            if device.tab() == tab {
                device.switch_link(url.clone());
                own = Some(device.id());
            } else if held {
                *device.phase_mut() = Phase::Lost(Text::new("session.let_go_for_other"));
            }
        }
        let id = match own {
            Some(id) => id,
            None => {
                let id = self.new_id();
                let kind = self.services.world.kinds.kind_for_tab(tab)?;
                let device = kind.for_link(id, url.clone(), &mut self.services);
                self.devices.push(device);
                id
            }
        };
        self.show(tab, id);
        Some(id)
    }

    /// Releases the connection of a session, unless the session is writing.
    ///
    /// If the link of the session is still being opened, the returned channel closes when the attempt has ended.
    ///
    /// # Errors
    /// Returns an error that names the session if it is writing.
    pub(super) fn release_connection(&mut self, url: &LinkUrl, why: Text) -> Result<Option<Receiver<()>>, Text> {
        let holds = |device: &&mut Box<AnyDevice>| {
            let held = device.is_connected() || device.is_opening();
            held && matches!(device.source(), Source::Link(own) if is_same_connection(own, url))
        };
        let Some(device) = self.devices.iter_mut().find_map(|device| Some(device).filter(holds)) else {
            return Ok(None);
        };
        let name = device.name();
        if device.is_writing() {
            return Err(Text::new("session.writes_there").with("name", name));
        }
        device.release_thread(JobState::Cancelled, &mut self.services);
        *device.phase_mut() = Phase::Lost(why.clone());
        let earlier = device.opening_mut().take().map(|opening| opening.over);
        self.services.notify(Severity::Note, vec![why], Some(&name));
        Ok(earlier)
    }

    pub(crate) fn reconnect(&mut self, id: SessionId) {
        let Some(device) = self.devices.iter_mut().find(|own| own.id() == id && !own.is_writing()) else { return };
        let Source::Link(url) = device.source().clone() else { return };
        device.release_thread(JobState::Cancelled, &mut self.services);
        self.open_session_link(id, url);
    }

    /// Opens a link for a session. If a drive may be on the line, the user is asked first. Listening is not enough,
    /// because a drive may read the encoder only at power-up and be silent afterwards.
    fn open_session_link(&mut self, id: SessionId, url: LinkUrl) {
        let kinds = self.services.world.kinds;
        let Some(device) = self.device_mut(id) else { return };
        if !kinds.kind_for_tab(device.tab()).is_some_and(|kind| kind.may_have_other_master(&url)) {
            return self.start_open_attempt(id, url, false);
        }
        *device.phase_mut() = Phase::Lost(Text::new("session.not_asked"));
        self.question = Some(Question::other_master(kinds.display_link(&url), FollowUpAction::OpenLink(id)));
    }

    pub(super) fn open_confirmed(&mut self, id: SessionId) {
        if let Some(Source::Link(url)) = self.device(id).map(|device| device.source()) {
            self.start_open_attempt(id, url.clone(), true);
        }
    }

    /// Starts an attempt to open a link for a session. Results of earlier attempts are then ignored.
    fn start_open_attempt(&mut self, id: SessionId, url: LinkUrl, is_sole_master: bool) {
        let attempt = self.next_number();
        self.release_tool_connections(&url);
        let Some(device) = self.devices.iter_mut().find(|device| device.id() == id) else { return };
        let earlier = device.opening_mut().take().map(|opening| opening.over);
        let over = device.open(url, attempt, earlier, &mut self.services);
        *device.phase_mut() = Phase::Opening;
        *device.opening_mut() = Some(PendingOpen { attempt: Some(attempt), over, is_sole_master });
    }

    pub(super) fn handle_opened(&mut self, done: ConnectAttempt) {
        let ConnectAttempt { session, attempt, result } = done;
        let own = |device: &&mut Box<AnyDevice>| device.id() == session && device.is_current_attempt(attempt);
        let Some(device) = self.devices.iter_mut().find(own) else {
            if let Ok(opened) = result {
                // The session was closed, or a newer attempt was started.
                opened.close_unused(session, &mut self.services);
            }
            return;
        };
        match result {
            Ok(opened) => {
                if let Source::Link(url) = device.source() {
                    self.settings.use_link(device.tab(), &self.services.world.kinds.display_link(url));
                }
                let taken = device.connect(opened, &mut self.services);
                self.report_wrong_kind(taken, session);
            }
            Err(failed) => {
                let why = device.open_failure_text(&failed);
                device.connection_lost(why, &mut self.services);
            }
        }
    }
}

impl Services {
    /// Opens a link on a thread once the connection is free. The returned channel closes when the connection is free
    /// again.
    pub(crate) fn open_task<D: Kind>(
        &mut self,
        url: LinkUrl,
        earlier: Option<Receiver<()>>,
        prepare: impl FnOnce(&mut Session<D>) + Send + 'static,
        done: impl FnOnce(Result<Box<OpenedConnection<D>>, Box<OpenFailure>>) -> TaskResult + Send + 'static,
    ) -> Receiver<()> {
        let (turn, over) = bounded(0);
        let (world, wake) = (self.world.clone(), self.tasks.wake_callback());
        let endings = self.sessions_closing_on_link(&url);
        self.tasks.run("open", move || {
            if let Some(earlier) = earlier {
                // Nothing is ever sent on this channel; it only closes.
                let _ = earlier.recv_timeout(world.patience.job);
            }
            let free = endings.into_iter().all(|(ending, patience)| ending.wait_for_end(patience));
            let result = if free { open(&world, &url, prepare, wake, turn) } else { Err(Box::new(OpenFailure::Held)) };
            Action::Done(done(result))
        });
        over
    }
}

fn open<D: Kind>(
    world: &StudioEnvironment,
    url: &LinkUrl,
    prepare: impl FnOnce(&mut Session<D>),
    wake: WakeCallback,
    turn: Sender<()>,
) -> Result<Box<OpenedConnection<D>>, Box<OpenFailure>> {
    let began = (world.now)();
    let mut session = world
        .given
        .get::<LinkOpener<D>>()
        .map_or_else(|| D::open(url, world.store.clone()), |opener| opener.open(url, world.store.clone()))
        .map_err(|error| Box::new(OpenFailure::Link(error)))?;
    prepare(&mut session);
    let (is_virtual, session_handle) = (session.is_virtual(), D::session_handle(&session));
    let trace: Ring<TraceEntry> =
        Ring::with_byte_limit(FRAMES, FRAME_BYTES, |entry| entry.bytes.len() + size_of_val(entry));
    let (ring, last) = (trace.clone(), WakeOnDrop(wake.clone()));
    session.add_watcher(move |entry| {
        let _ = &last;
        ring.push(entry.clone());
    });
    match Worker::spawn(session, wake) {
        Ok(worker) => {
            Ok(Box::new(OpenedConnection { worker, session_handle, trace, is_virtual, began, url: url.clone(), turn }))
        }
        Err(error) => Err(Box::new(OpenFailure::Thread(error.to_string()))),
    }
}

/// A guard that wakes the window when the thread of a session ends for any reason.
struct WakeOnDrop(WakeCallback);

impl Drop for WakeOnDrop {
    fn drop(&mut self) {
        (self.0)();
    }
}
