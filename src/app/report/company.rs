//! The company named in reports, taken from the settings.

use std::path::Path;

use super::format::pdf_error_text;
use crate::app::{Settings, Text, explain};
use crate::report::{Company, pdf};
use crate::store::read_bytes;

/// Returns the company with its logo, or `None` if the settings contain neither a name nor a logo.
///
/// # Errors
/// Returns a message if the logo cannot be read.
pub fn company(settings: &Settings) -> Result<Option<Company>, Text> {
    let (name, path) = (settings.company.clone(), settings.company_logo.as_deref());
    let logo = path.map(|path| read_bytes(Path::new(path))).transpose();
    let logo = logo.map_err(|error| explain::file_error_text(&error))?;
    let is_known = name.is_some() || logo.is_some();
    Ok(is_known.then(|| Company { name: name.unwrap_or_default(), logo }))
}

/// Checks that the company name and logo from the settings can be used in reports. This function reads files, so it
/// runs in a task.
///
/// # Errors
/// Returns a message if the logo cannot be read or is not a PNG file.
pub fn check_company(settings: &Settings) -> Result<(), Text> {
    match company(settings)?.and_then(|company| company.logo) {
        Some(logo) => pdf::check_logo(logo).map_err(|error| pdf_error_text(&error)),
        None => Ok(()),
    }
}
