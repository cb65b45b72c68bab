//! The tables of codes that a description can name.

use super::super::procedure::{
    CalibrationCommand, CalibrationStatus, DataCommand, DataStatus, FilterCommand, FilterStatus, PresetCommand,
    PresetStatus, WiegandCommand, WiegandStatus,
};
use super::super::status::DeviceMode;

/// A register whose codes are the program's, named by a description in place of a list of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum CodeTable {
    /// [`DeviceMode`].
    DeviceMode,
    /// [`WiegandCommand`].
    WiegandCommand,
    /// [`WiegandStatus`].
    WiegandStatus,
    /// [`CalibrationCommand`].
    CalibrationCommand,
    /// [`CalibrationStatus`].
    CalibrationStatus,
    /// [`DataCommand`].
    DataCommand,
    /// [`DataStatus`].
    DataStatus,
    /// [`FilterCommand`].
    FilterCommand,
    /// [`FilterStatus`].
    FilterStatus,
    /// [`PresetCommand`].
    PresetCommand,
    /// [`PresetStatus`].
    PresetStatus,
}

impl CodeTable {
    /// Returns the codes with their names.
    pub(super) const fn rows(self) -> &'static [(u8, &'static str)] {
        match self {
            CodeTable::DeviceMode => DeviceMode::TABLE,
            CodeTable::WiegandCommand => WiegandCommand::TABLE,
            CodeTable::WiegandStatus => WiegandStatus::TABLE,
            CodeTable::CalibrationCommand => CalibrationCommand::TABLE,
            CodeTable::CalibrationStatus => CalibrationStatus::TABLE,
            CodeTable::DataCommand => DataCommand::TABLE,
            CodeTable::DataStatus => DataStatus::TABLE,
            CodeTable::FilterCommand => FilterCommand::TABLE,
            CodeTable::FilterStatus => FilterStatus::TABLE,
            CodeTable::PresetCommand => PresetCommand::TABLE,
            CodeTable::PresetStatus => PresetStatus::TABLE,
        }
    }
}
