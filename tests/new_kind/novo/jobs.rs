//! The jobs of a session with a Novo encoder, including its part of a write.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use encoder_studio::bits::MaskedBytes;
use encoder_studio::link::{ByteLink, Clock, Ctx, Direction, LinkError, LinkScheme, LinkUrl, RealClock};
use encoder_studio::profile::{InterruptedWrite, RestoreOptions, WrittenChanges};
use encoder_studio::store::{DeviceKey, Store};
use encoder_studio::units::{CharacterFormat, Moment};
use encoder_studio::worker::commit::{ApprovedPlan, CycleCount, cycles_seen, write_plan};
use encoder_studio::worker::open::{check_parameters, connect_simulated, open_byte_stream, wrong_target_error};
use encoder_studio::worker::{self, Device, JobReport, OpenError, Progress, Session, SessionContext, WatchReply};

use super::profile::{NovoPlan, NovoProfile, Op, plan};
use super::protocol::{KIND, POSITION, REPLY, Request, SERIAL, Values, item_address, parse_reply};
use super::sim::Virtual;
use super::write::NovoWrite;

/// Number of write cycles that the memory allows.
pub(crate) const MAX_WRITE_CYCLES: u64 = 10_000;
const TRIES: u16 = 3;
const NOVO_REPLY_TIMEOUT: Duration = Duration::from_millis(300);

/// A connected encoder.
pub(crate) struct Novo(pub(crate) Box<dyn ByteLink>);

/// Time and position of a sample.
pub(crate) type Sample = (Moment, u16);

/// A change that the user wants to write.
#[derive(Clone, Debug)]
pub(crate) struct Change {
    /// The serial number of the profile to restore, or `None` to write edits.
    pub(crate) restored: Option<u16>,
    pub(crate) values: Values,
    pub(crate) options: RestoreOptions,
}

#[derive(Clone, Debug)]
pub(crate) struct Prepared {
    pub(crate) serial: u16,
    pub(crate) plan: NovoPlan,
    pub(crate) seen: Option<CycleCount>,
}

#[derive(Debug)]
pub(crate) enum Job {
    Survey,
    Position,
    Prepare(Change),
    Commit(Box<ApprovedPlan<Prepared>>),
}

#[derive(Debug)]
pub(crate) enum Output {
    Surveyed(NovoProfile),
    Position(Sample),
    Prepared(Box<Prepared>),
    Committed(Box<worker::CommitResult<WrittenChanges>>),
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Error {
    #[error("cancelled")]
    Cancelled,
    #[error("there is no answer")]
    Silent,
    #[error("it is no longer as it was when the plan was made")]
    Changed,
    #[error("{0} was not taken")]
    NotAccepted(&'static str),
    #[error("the profile is of serial number {profile}, the encoder has {device}")]
    OtherDevice { profile: u16, device: u16 },
    #[error(transparent)]
    Link(#[from] LinkError),
}

pub(crate) type JobError = worker::JobError<Error, Infallible, InterruptedWrite<Op, Error, WrittenChanges, ()>, ()>;

/// Checks a link as far as possible without opening it.
pub(crate) fn check(url: &LinkUrl) -> Result<(), OpenError> {
    match url.scheme {
        LinkScheme::Sim => Virtual::from_pairs(url.query.pairs()).map(drop)?,
        LinkScheme::Serial | LinkScheme::Tcp => check_parameters(&url.query, url.scheme, &[])?,
        other => return Err(wrong_target_error(other, "sim:, serial:, tcp:")),
    }
    Ok(())
}

pub(crate) fn open(url: &LinkUrl, store: Store) -> Result<Session<Novo>, OpenError> {
    check(url)?;
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let virtual_one = || Ok(connect_simulated(Virtual::from_pairs(url.query.pairs())?, &clock));
    let wire = open_byte_stream(url, CharacterFormat::FACTORY, &clock, virtual_one)?;
    Ok(Session::from_device(Novo(wire), clock, store, url.scheme == LinkScheme::Sim))
}

pub(crate) fn device_key(serial: u16, is_virtual: bool) -> DeviceKey {
    DeviceKey::new(KIND, "N1", &serial.to_string(), is_virtual)
}

impl Novo {
    pub(super) fn ask(&mut self, context: &mut SessionContext, request: Request) -> Result<u16, Error> {
        let Ctx { wire, clock, cancel, trace } = context.procedure_context(&mut *self.0);
        for _ in 0..TRIES {
            if cancel.stops_transaction() {
                return Err(Error::Cancelled);
            }
            trace.record_frame(clock.now(), Direction::Sent, MaskedBytes::unmasked(&request.emit()));
            wire.send(&request.emit())?;
            let (until, mut heard) = (clock.now() + NOVO_REPLY_TIMEOUT, Vec::new());
            while heard.len() < REPLY && clock.now() < until {
                wire.receive(until, &mut heard)?;
            }
            trace.record_frame(clock.now(), Direction::Received, MaskedBytes::unmasked(&heard));
            if let Some(word) = parse_reply(request, &heard) {
                return Ok(word);
            }
        }
        Err(Error::Silent)
    }
    pub(super) fn survey(&mut self, context: &mut SessionContext) -> Result<NovoProfile, Error> {
        let serial = self.ask(context, Request::Read(SERIAL))?;
        let mut values = Values::default();
        for (item, value) in values.iter_mut().enumerate() {
            *value = self.ask(context, Request::Read(item_address(item)))?;
        }
        Ok(NovoProfile { serial, values })
    }
    fn prepare(&mut self, context: &mut SessionContext, change: &Change) -> Result<Prepared, Error> {
        let now = self.survey(context)?;
        if let Some(profile) = change.restored.filter(|own| *own != now.serial && !change.options.allow_other_device) {
            return Err(Error::OtherDevice { profile, device: now.serial });
        }
        let seen = cycles_seen(&context.log(), &context.store, &device_key(now.serial, context.is_virtual));
        Ok(Prepared { serial: now.serial, plan: plan(&now, &change.values), seen })
    }
}

pub(super) type Told<'t> = &'t mut dyn FnMut(JobReport<Infallible, usize>);

impl Device for Novo {
    type Job = Job;
    type Output = Output;
    type Error = JobError;
    type DeviceMessage = Infallible;
    type Sample = Sample;
    type Watch = Infallible;
    /// The index of the item being written.
    type JobStep = usize;

    fn run(&mut self, context: &mut SessionContext, job: Job, tell: Told<'_>) -> Result<Output, JobError> {
        Ok(match job {
            Job::Survey => Output::Surveyed(self.survey(context)?),
            Job::Position => Output::Position(self.take_sample(context)?),
            Job::Prepare(change) => Output::Prepared(Box::new(self.prepare(context, &change)?)),
            Job::Commit(own) => {
                let (store, is_virtual) = (context.store.clone(), context.is_virtual);
                let told = &mut |at: Progress<&Op>| tell(JobReport::Progress(at.map_step(|op| op.item)));
                let written = write_plan(&store, is_virtual, &own, &mut NovoWrite { novo: self, context }, told)?;
                Output::Committed(Box::new(written))
            }
        })
    }
    fn take_sample(&mut self, context: &mut SessionContext) -> Result<Sample, JobError> {
        let position = self.ask(context, Request::Read(POSITION))?;
        Ok((context.clock.now(), position))
    }
    fn read_watched(&mut self, _: &mut SessionContext, what: &Infallible) -> Result<WatchReply<Sample>, JobError> {
        match *what {}
    }
    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.0.check_connection()
    }
}
