//! `report`: a report of a profile or a device.

use std::path::Path;

use jiff::Zoned;
use serde_json::json;

use super::args::{CommonArgs, ReportArgs, ReportLanguage};
use super::consent::confirm_replacement;
use super::log::profile_path;
use super::output::Output;
use super::profiles::{load, read_document};
use super::runner::to_failure;
use super::user_store::{exchange_entries, user_store};
use super::{Failure, Result, Success};
use crate::app::report::{ReportContext, ReportFormat, ReportRequest, company, current_time_text, file_name};
use crate::app::{CommandSettings, Language, explain};
use crate::link::LinkUrl;
use crate::profile::Body;
use crate::report::Report;
use crate::store::write_atomically;

pub(super) fn report(common: &CommonArgs, output: &Output, arguments: &ReportArgs) -> Result {
    let file = &arguments.file;
    let format = ReportFormat::of_file(file)
        .ok_or_else(|| Failure::Usage(format!("{}: a report ends in .html or .pdf", file.display())))?;
    let compared =
        arguments.compare.as_deref().map(|argument| compared_profile(common, output, argument)).transpose()?;
    let replaces = confirm_replacement(file, arguments.force)?;
    let store = user_store(common)?;
    let context = ReportContext::new(&store, language(arguments.language));
    let other = || output.commands().kind_commands().find_map(|own| own.report(output, arguments, &context));
    let report = match common.link.is_none().then(other).flatten() {
        Some(_) if compared.is_some() => {
            return Err(Failure::Usage("--compare is for profiles and devices".to_owned()));
        }
        Some(report) => report?,
        None => {
            let request = match &common.link {
                Some(url) => read_device(common, output, arguments, url)?,
                None => read_profile(common, output, arguments)?,
            };
            let request = ReportRequest { compared, asset: arguments.asset.clone(), ..request };
            // The entries of other benches belong to the history too.
            exchange_entries(&store);
            request.create(output.kinds(), &store).map_err(|why| to_failure(&why))?
        }
    };
    let CommandSettings { settings, .. } = CommandSettings::read(&store.settings_path());
    let report = Report { company: company(&settings).map_err(|why| to_failure(&why))?, ..report };
    let printed = current_time_text(&Zoned::now(), context.language);
    let bytes = format.render(&report, &printed).map_err(|why| to_failure(&why))?;
    write_atomically(file, &bytes).map_err(|error| to_failure(&explain::file_error_text(&error)))?;
    replaces.report_replacement(output);
    let hash = report.content_hash();
    let json = json!({"file": file, "report_number": hash.report_number(), "sha256": hash.to_string()});
    output.show(&json, &format!("{}: report {}\n", file.display(), hash.report_number()))?;
    Ok(Success::Completed)
}

fn read_profile(common: &CommonArgs, output: &Output, arguments: &ReportArgs) -> Result<ReportRequest> {
    let path = profile_path(common, &arguments.subject)?;
    let document = read_document(output, &path)?;
    Ok(ReportRequest::for_profile(&path, document, language(arguments.language)))
}

fn read_device(common: &CommonArgs, output: &Output, arguments: &ReportArgs, url: &LinkUrl) -> Result<ReportRequest> {
    let name = arguments.subject.to_string_lossy();
    let kind = output.commands().device(&name).map_err(|_| {
        let known: Vec<&str> = output.commands().devices().iter().map(|device| device.name()).collect();
        Failure::Usage(format!("{name:?} is not a kind of device; with --link, report takes {}", known.join(", ")))
    })?;
    let reading = kind.read_for_report(common, output)?;
    Ok(ReportRequest::for_device(url, output.kinds(), reading, language(arguments.language)))
}

fn compared_profile(common: &CommonArgs, output: &Output, argument: &Path) -> Result<(String, Body)> {
    let path = profile_path(common, argument)?;
    Ok((file_name(&path), load(output, &path)?))
}

const fn language(chosen: ReportLanguage) -> Language {
    match chosen {
        ReportLanguage::En => Language::English,
        ReportLanguage::De => Language::German,
    }
}
