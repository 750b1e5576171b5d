//! Devices other than the own board: where they are, and the link to them; drives among them may follow a profile. Their protocols are those of `socam_sources`.

mod address;
mod attendant;
mod bus;
mod link;
mod listen;
mod listener;
mod report;
mod row;
mod run;
#[cfg(all(target_os = "linux", feature = "formats-can"))]
mod socket;
mod writer;

pub(crate) use address::{Place, Protocol, SourceAddress};
#[cfg(feature = "window")]
pub(crate) use attendant::Attendant;
pub(crate) use attendant::Terminal;
#[cfg(feature = "formats-can")]
pub(crate) use bus::Bus;
pub(crate) use bus::Node;
pub(crate) use link::Link;
pub(crate) use listen::{Listened, listen};
pub(crate) use listener::{Got, Listener};
#[cfg(feature = "window")]
pub(crate) use report::clock_text;
pub(crate) use report::{SourceEnd, SourcePlan, SourceReport};
pub(crate) use row::Row;
pub(crate) use run::record;
pub(crate) use writer::{SourceWriter, sample};
