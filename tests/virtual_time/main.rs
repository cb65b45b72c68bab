//! Tests of the worker, the procedures and the virtual devices in virtual time. The code is the same as with real
//! hardware, but the test controls the timing of every byte. There is one module per behaviour.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

mod adapter_line;
mod biss;
mod echo;
mod faults;
mod find;
mod hiperdrive;
mod hiperdrive_motion;
mod interbus;
mod interruption;
mod keeping;
mod late;
mod lost_replies;
mod noise;
mod plan_rules;
mod polling;
mod position;
mod recorded;
mod rest;
mod settings;
mod ssi;
mod support;
mod survey;
mod threads;
mod watching;
