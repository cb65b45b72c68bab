//! EtherNet/IP: encapsulation, common packet format, and the CIP messages of an adapter with one cyclic connection. The
//! types serve both host and device. Unknown values are preserved.
//!
//! Source: section 7 of the project's HIPERDRIVE reference, and the public parts of ODVA's CIP networks library as
//! quoted there (`P ODVA`). Integers are little-endian, except in socket addresses.
//!
//! ```text
//! TCP  encapsulation header (24) │ interface, time-out │ items: null, unconnected data ( CIP request or reply )
//! UDP  items: sequenced address, connected data ( count │ run/idle header where there is one │ process data )
//! ```

#![warn(missing_docs)]

mod arrivals;
mod connection;
mod encapsulation;
mod fields;
mod forward;
mod identity;
mod io;
mod items;
mod message;
mod path;
mod receiver;
mod status;
mod tcp_ip;
#[cfg(test)]
mod vectors;

pub use arrivals::{PacketTracker, PacketVerdict};
pub use connection::{
    ConnectionTimeout, NetworkParameters, NetworkPriority, NetworkType, RequestTimeout, Transport, Trigger,
};
pub use encapsulation::{Body, Command, Frame};
pub use fields::{PacketError, PacketField, Structure};
pub use forward::{
    ConnectionOwner, ForwardClose, ForwardCloseSuccess, ForwardErrorReply, ForwardOpen, ForwardOpenSuccess,
};
pub use identity::{Identity, IdentityItem, Revision};
pub use io::{IoPacket, RealTimeFormat, RunIdleHeader};
pub use items::{Item, ItemList, SocketAddress};
pub use message::{Reply, Request, Service, class_name};
pub use path::{EPath, ElectronicKey, LogicalKind, Segment, Width};
pub use receiver::Receiver;
pub use status::{
    ENCAPSULATION_STATUS, EXTENDED_STATUS, EncapsulationStatus, ExtendedStatusTableRow, GENERAL_STATUS, GeneralStatus,
    StatusTableRow, find_extended_status,
};
pub use tcp_ip::{AddressError, AddressSource, ConfigurationControl, InterfaceConfiguration};

/// TCP port for explicit messages, and UDP port for ListIdentity.
pub const EXPLICIT_MESSAGE_PORT: u16 = 44818;
/// Default UDP port for cyclic data. Another port can be given when a connection is opened.
pub const IMPLICIT_MESSAGE_PORT: u16 = 2222;
