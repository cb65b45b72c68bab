//! The company that makes a report, as the settings name it.

use std::path::Path;

use crate::app::{Settings, Text, explain};
use crate::report::Company;
use crate::store::read_bytes;

/// Returns the company with its logo. Returns `None` if the settings name neither.
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
