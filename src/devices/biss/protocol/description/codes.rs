//! Built-in code tables that a description can refer to.

use super::super::procedure::{
    CalibrationCommand, CalibrationStatus, DataCommand, DataStatus, FilterCommand, FilterStatus, PresetCommand,
    PresetStatus, WiegandCommand, WiegandStatus,
};
use super::super::status::DeviceMode;

/// A built-in code table, which a description can name instead of listing the values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum CodeTable {
    DeviceMode,
    WiegandCommand,
    WiegandStatus,
    CalibrationCommand,
    CalibrationStatus,
    DataCommand,
    DataStatus,
    FilterCommand,
    FilterStatus,
    PresetCommand,
    PresetStatus,
}

impl CodeTable {
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
