//! Services that the application provides to sessions: the environment, task threads, the notice log and the job list.

use std::any::{Any, TypeId};
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

use jiff::Zoned;

use super::Text;
use super::brakes::DriveStopHandles;
use super::file_question::FileQuestion;
use super::kinds::KindRegistry;
use super::notices::{Notice, NoticeLog, Severity};
use super::remote::is_remote_session;
use super::shutdown::{ClosingSession, GracePeriods};
use super::studio::SessionId;
use super::tasks::{TaskRunner, WakeCallback};
use super::type_map::TypeMap;
use crate::link::{LinkError, PortInfo};
use crate::store::{BaseFolders, Store};
use crate::worker::JobId;

/// Access to everything outside the application state, such as files, serial ports and the clock. Tests replace it.
#[derive(Clone)]
pub struct StudioEnvironment {
    pub store: Store,
    /// Values supplied by the caller for kinds of devices.
    pub given: TypeMap,
    pub kinds: KindRegistry,
    pub ports: Arc<dyn Fn() -> Result<Vec<PortInfo>, LinkError> + Send + Sync>,
    /// Folders to which relative paths refer.
    pub folders: BaseFolders,
    pub now: Arc<dyn Fn() -> Zoned + Send + Sync>,
    /// Whether the window is operated over a remote desktop.
    pub is_remote: Arc<dyn Fn() -> bool + Send + Sync>,
    /// Maximum waiting times for closing sessions or the window.
    pub patience: GracePeriods,
}

impl StudioEnvironment {
    pub fn production(store: Store, kinds: KindRegistry) -> Self {
        StudioEnvironment {
            store,
            given: TypeMap::default(),
            kinds,
            ports: Arc::new(crate::link::ports),
            folders: BaseFolders::for_current_user(),
            now: Arc::new(Zoned::now),
            is_remote: Arc::new(is_remote_session),
            patience: GracePeriods::default(),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobState {
    Running,
    Done,
    Failed(Text),
    Cancelled,
}

#[derive(Clone, Debug)]
pub struct JobRecord {
    pub since: Zoned,
    pub until: Option<Zoned>,
    pub about: String,
    pub title: Text,
    pub end: JobState,
    key: (SessionId, JobId),
}

pub struct Services {
    pub(crate) world: StudioEnvironment,
    pub(crate) tasks: TaskRunner,
    pub log: NoticeLog,
    /// Jobs, newest last.
    jobs: VecDeque<JobRecord>,
    pub(crate) file_question: Option<FileQuestion>,
    pub(crate) brakes: DriveStopHandles,
    /// Released sessions that have not ended yet.
    pub(super) closing_sessions: Vec<ClosingSession>,
    pub(super) opening_files: Vec<std::path::PathBuf>,
    pub(super) drafts_on_their_way: usize,
    /// Data shared by all sessions of a kind of device, by type.
    shared: HashMap<TypeId, Box<dyn Any>>,
}

impl Services {
    const MAX_JOB_RECORDS: usize = 500;

    /// Returns the value of this type that is shared by all sessions of a kind of device, if any.
    pub fn shared_data<T: Any>(&self) -> Option<&T> {
        self.shared.get(&TypeId::of::<T>())?.downcast_ref()
    }

    /// Shares a value with all sessions of a kind of device, replacing an earlier value of the same type.
    pub fn share_value<T: Any>(&mut self, value: T) {
        self.shared.insert(TypeId::of::<T>(), Box::new(value));
    }

    pub(crate) fn new(world: StudioEnvironment, wake: WakeCallback) -> Self {
        let (log, jobs) = (NoticeLog::default(), VecDeque::new());
        let (tasks, closing_sessions) = (TaskRunner::new(wake), Vec::new());
        let opening_files = Vec::new();
        Services {
            world,
            tasks,
            log,
            jobs,
            file_question: None,
            brakes: DriveStopHandles::default(),
            closing_sessions,
            opening_files,
            drafts_on_their_way: 0,
            shared: HashMap::new(),
        }
    }

    pub(crate) fn is_remote(&self) -> bool {
        (self.world.is_remote)()
    }

    pub(crate) fn current_time(&self) -> Zoned {
        (self.world.now)()
    }

    pub(crate) fn notify(&mut self, severity: Severity, texts: Vec<Text>, about: Option<&str>) {
        self.log.add(self.create_notice(severity, texts, about));
    }

    /// Adds a notice about one part of a device to the log, and displays it in the window.
    pub(crate) fn notify_device_part(
        &mut self,
        severity: Severity,
        texts: Vec<Text>,
        (about, part): (Option<&str>, Option<Text>),
    ) {
        self.log.add(Notice { part, ..self.create_notice(severity, texts, about) });
    }

    /// Adds a notice to the log only, because the window already shows the same text elsewhere.
    pub(crate) fn log_without_display(&mut self, severity: Severity, texts: Vec<Text>, about: Option<&str>) {
        self.log.add_to_log(self.create_notice(severity, texts, about));
    }

    fn create_notice(&self, severity: Severity, texts: Vec<Text>, about: Option<&str>) -> Notice {
        Notice { at: self.current_time(), severity, texts, about: about.map(ToOwned::to_owned), part: None }
    }

    pub fn jobs(&self) -> impl DoubleEndedIterator<Item = &JobRecord> + ExactSizeIterator {
        self.jobs.iter()
    }

    pub(super) fn record_job_start(&mut self, session: SessionId, id: JobId, about: &str, what: Text) {
        let about = about.to_owned();
        let since = self.current_time();
        self.jobs.push_back(JobRecord {
            since,
            until: None,
            about,
            title: what,
            end: JobState::Running,
            key: (session, id),
        });
        if self.jobs.len() > Self::MAX_JOB_RECORDS {
            self.jobs.pop_front();
        }
    }

    pub(crate) fn end_job(&mut self, session: SessionId, id: JobId, end: JobState) {
        let now = self.current_time();
        if let Some(job) = self.jobs.iter_mut().rev().find(|job| job.key == (session, id)) {
            job.end = end;
            job.until = Some(now);
        }
    }
}
