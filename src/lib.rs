//! encoder-studio: configure position encoders and small drives at a desk.
//!
//! ARCHITECTURE.md describes the house: six floors, and a file uses only what lies below its own.

// floor 1: words and numbers
pub mod analysis;
pub mod bits;
pub mod buses;
pub mod devices;
pub mod signals;
pub mod units;

// floor 2: bytes ↔ meaning, and what is saved
pub mod profile;

// floor 3: the world outside
pub mod link;
pub mod sim;
pub mod store;

// floor 4: what one does with a device
pub mod device;
pub mod worker;

// floor 5: what the program can do, without drawing
pub mod app;
pub mod cli;

// floor 6: drawing
pub mod ui;

// above all: which devices there are
pub mod kinds;
