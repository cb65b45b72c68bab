//! Tests of the built program: independently written encoders on real pseudo-terminals, the virtual encoder checked by
//! an independent host, and invalid input.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

mod adapter_line;
mod biss_bad_input;
mod biss_guided;
mod biss_offline;
mod biss_profile;
mod biss_reading;
mod biss_simulate;
mod biss_tour;
mod biss_writing;
mod cli_actions;
mod cli_analyse;
mod cli_bad_input;
mod cli_codes;
mod cli_consent;
mod cli_faults;
mod cli_log;
mod cli_offline;
mod cli_ports;
mod cli_position;
mod cli_settings;
mod cli_simulate;
mod cli_ssi;
mod cli_status;
mod cli_undo;
mod foreign;
mod going;
mod hiperdrive_bad_input;
mod hiperdrive_foreign;
mod hiperdrive_move;
mod hiperdrive_offline;
mod hiperdrive_reading;
mod hiperdrive_safety;
mod hiperdrive_simulate;
mod hiperdrive_tap;
mod hiperdrive_writing;
mod interbus_bad_input;
mod interbus_foreign;
mod interbus_offline;
mod interbus_reading;
mod interbus_simulate;
mod interbus_writing;
mod logbook_server;
mod logbook_transfer;
mod postgres;
mod recorded;
mod report;
mod source;
mod ssi_export;
mod ssi_live;
mod ssi_profiles;
mod ssi_recordings;
mod ssi_simulate;
mod support;
