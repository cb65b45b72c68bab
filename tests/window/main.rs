//! What the window does, driven as a person would: its state by actions, without drawing, and its real widgets by their
//! accessible labels. One module a behaviour.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

mod biss;
mod biss_exchange;
mod biss_stream;
mod biss_support;
mod biss_writing;
mod blocking;
mod closing;
mod commutation;
mod connecting;
mod drafts;
mod each_kind;
mod hiperdrive;
mod hiperdrive_axis;
mod hiperdrive_control;
mod hiperdrive_motion;
mod interbus;
mod leaving;
mod losing;
mod monkey;
mod profiles;
mod recording;
mod remembering;
mod screen;
mod served;
mod signals;
mod signals_adapter;
mod signals_beside;
mod signals_calculators;
mod signals_live;
mod signals_widgets;
mod ssi;
mod state;
mod support;
mod texts;
mod widgets_commutation;
mod widgets_hiperdrive_setup;
mod widgets_idle;
mod widgets_interbus;
mod widgets_pages;
mod widgets_plot;
mod widgets_ssi;
mod widgets_writing;
mod wire;
mod writing;
