//! Connecting: what a person fills in, and what is offered to him. It opens nothing.

mod form;
mod ports;

pub use form::{LinkForm, LinkKind};
pub use ports::{Offer, offered_ports};
