//! The command-line part of the test kind.

use encoder_studio::app::TypeMap;
use encoder_studio::cli::{
    CliDevice, Command, CommonArgs, DeviceCommands, Failure, Output, Position, ProfileCommands, Restore, Result,
    SaveArgs, ServableDevice, SimulateArgs, Success, UnrestoredItems, check_wear, confirm_plan, plan, print_readings,
    profile_to_restore, restore_options, save_profile, settings, write_restore,
};
use encoder_studio::profile::{Body, Operation};
use encoder_studio::result_of;
use encoder_studio::worker::Session;
use serde_json::json;

use super::jobs::{Change, Job, MAX_WRITE_CYCLES, Novo, Output as Came, Prepared};
use super::profile::NovoProfile;
use super::protocol::{ITEMS, KIND, name_of};
use super::sim::Virtual;

type Runner = encoder_studio::cli::Runner<Novo>;

impl CliDevice for Novo {
    type Context = ();
    const COMMANDS: &'static dyn DeviceCommands = &NovoCommands;

    fn prepare_context(_: &mut Session<Self>, _: &TypeMap) {}

    fn describe_step(item: &usize) -> String {
        name_of(*item).to_owned()
    }
}

pub(crate) struct NovoCommands;

impl DeviceCommands for NovoCommands {
    fn name(&self) -> &'static str {
        KIND
    }
    fn description(&self) -> &'static str {
        "Novo encoder"
    }
    fn run(&self, common: &CommonArgs, output: &Output, command: &Command) -> Option<Result> {
        Some(match command {
            Command::Identify(_) => identify(common, output),
            Command::Position(wanted) => position(common, output, wanted),
            Command::Save(wanted) => save(common, output, wanted),
            _ => return None,
        })
    }
    fn create_simulated(&self, output: &Output, arguments: &SimulateArgs) -> Result<Box<dyn ServableDevice>> {
        let device = Virtual::from_pairs(&settings(output, arguments)?);
        device.map(|own| Box::new(own) as Box<dyn ServableDevice>).map_err(|error| Failure::Usage(error.to_string()))
    }
}

impl ProfileCommands for NovoCommands {
    fn restore(&self, common: &CommonArgs, output: &Output, restore: &Restore, profile: Body) -> Result {
        let options = restore_options(restore)?;
        let NovoProfile { serial, values } = profile_to_restore(restore, profile)?;
        let mut runner = Runner::open(common)?;
        let change = Change { restored: Some(serial), values, options };
        let prepared = result_of!(runner.run(Job::Prepare(change))?, Came::Prepared(prepared) => *prepared);
        let shown = shown(&prepared);
        let unchanged = (ITEMS.len() - prepared.plan.ops.len()) as u64;
        let left = UnrestoredItems { unchanged, missing: Vec::new(), redo: Vec::new() };
        write_restore(common, output, restore, prepared, &shown, &left, |prepared| {
            check_wear::<Novo>(&restore.consent, &prepared)?;
            let agreed = confirm_plan(&runner, output, &restore.consent, prepared, &[&shown.text])?;
            let written = result_of!(runner.run(Job::Commit(Box::new(agreed)))?, Came::Committed(written) => *written);
            Ok(plan::WriteSummary::from_commit(output, written))
        })
    }
    fn read_for_comparison(&self, common: &CommonArgs, _: &Output, _: Option<&Body>) -> Result<Body> {
        survey(&mut Runner::open(common)?).map(Body::new)
    }
}

fn identify(common: &CommonArgs, output: &Output) -> Result {
    let NovoProfile { serial, .. } = survey(&mut Runner::open(common)?)?;
    output.show(&json!({ "serial": serial }), &format!("serial number  {serial}\n"))?;
    Ok(Success::Completed)
}

fn position(common: &CommonArgs, output: &Output, position: &Position) -> Result {
    let mut runner = Runner::open(common)?;
    if position.csv {
        output.write_stdout("position\n")?;
    }
    let job = || Job::Position;
    print_readings(&mut runner, position, job, |came| {
        let (_, position) = result_of!(came, Came::Position(sample) => sample);
        output.show(&json!({ "position": position }), &format!("{position}\n"))
    })
}

fn save(common: &CommonArgs, output: &Output, save: &SaveArgs) -> Result {
    save_profile(common, &save.file, Body::new(survey(&mut Runner::open(common)?)?))?;
    output.show(&json!({ "file": save.file }), &format!("{}\n", save.file.display()))?;
    Ok(Success::Completed)
}

fn survey(runner: &mut Runner) -> Result<NovoProfile> {
    Ok(result_of!(runner.run(Job::Survey)?, Came::Surveyed(read) => read))
}

fn shown(Prepared { plan, seen, .. }: &Prepared) -> plan::PlanReport {
    let step = |op: &super::profile::Op| {
        let (old, new) = (Some(op.from.to_string()), Some(op.to.to_string()));
        plan::PlanStep { item: op.name().to_owned(), old, new, write_cycles: op.write_cycles() }
    };
    plan::PlanReport::from_plan(plan, plan.ops.iter().map(step).collect(), *seen, Some(MAX_WRITE_CYCLES))
}
