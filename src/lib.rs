//! encoder-studio: configures position encoders and small drives.
//!
//! ARCHITECTURE.md describes the layers. A module uses only its own layer and the ones below, and the core is
//! independent of the devices.

// all device kinds
pub mod kinds;

pub mod buses;
pub mod devices;
pub mod signals;

// the core, from the highest layer down: drawing
pub mod ui;

// the program without drawing
pub mod app;
pub mod cli;

// a device's session
pub mod worker;

// wires, virtual devices, files
pub mod link;
pub mod sim;
pub mod store;

// profiles, plans and the analysis of samples; no I/O
pub mod analysis;
pub mod bits;
pub mod drawing;
pub mod expected;
pub mod fonts;
pub mod parameter;
pub mod profile;
pub mod report;
pub mod units;
