//! The content of a report, as provided by a kind of device.

use crate::app::{Language, Text, format_decimal, significant_decimals};
use crate::report::{CellStyle, Fact, Section, Table};
use crate::store::{DeviceKey, Store};

/// The values of a device with their descriptions.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportContent {
    /// Name and serial number of the device.
    pub title: String,
    /// Key of the device in the logbook, or `None` if the profile belongs to no particular device. A profile does not
    /// state whether the device is virtual.
    pub key: Option<DeviceKey>,
    pub sections: Vec<Section>,
}

/// The language of a report, and the store with the user's tables.
#[derive(Clone, Copy, Debug)]
pub struct ReportContext<'a> {
    pub store: &'a Store,
    pub language: Language,
}

impl<'a> ReportContext<'a> {
    pub fn new(store: &'a Store, language: Language) -> Self {
        ReportContext { store, language }
    }

    /// Returns a text in the report's language.
    pub fn localize(&self, text: impl Into<Text>) -> String {
        text.into().to_string_in(self.language)
    }

    /// Creates a label–value pair whose value is text.
    pub fn fact(&self, label: impl Into<Text>, value: impl Into<Text>) -> Fact {
        Fact::new(self.localize(label), self.localize(value))
    }

    /// Creates a label–value pair whose value is an identifier, an address or bytes. An empty value is shown as a dash.
    pub fn code(&self, label: impl Into<Text>, value: impl Into<String>) -> Fact {
        let value: String = value.into();
        let shown = if value.trim().is_empty() { NONE.to_owned() } else { value };
        Fact::code(self.localize(label), shown)
    }

    /// Formats a number with the decimal separator of the report's language.
    pub fn number(&self, value: f64, decimals: usize) -> String {
        format_decimal(value, decimals, self.language)
    }

    /// Formats a number with as many decimals as it needs.
    pub fn format_shortest_number(&self, value: f64) -> String {
        self.number(value, significant_decimals(value))
    }

    /// Creates a table without rows.
    pub fn table<const N: usize>(&self, columns: [(Text, CellStyle); N]) -> Table {
        Table::new(columns.map(|(heading, style)| (self.localize(heading), style)))
    }
}

/// Placeholder for a missing value.
pub(super) const NONE: &str = "–";
