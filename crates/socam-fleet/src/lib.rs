//! Identification and diagnosis of a fleet: one row for each of up to a million recordings of sister machines, and what the rows say
//! together.
//!
//! * [`diagnose_one`] is the core: a recording, a model, options and a seed give one [`Row`]. Bad input is a row with a
//!   [`Status`](row::Status) and a sentence. [`to_batch`] turns rows into Arrow columns ([`schema`], `socam.fleet/1`).
//! * The cascade: a check; a fit and the score test under [`Frozen`] noise; the full diagnosis only where something stands out.

mod batch;
mod collected;
mod error;
mod fill;
pub mod labels;
mod listing;
mod one;
mod options;
mod part;
pub mod row;
mod run;
mod source;
pub mod statistics;
mod summary;
pub mod table;
pub mod words;

pub use batch::{from_batch, schema, to_batch};
pub use collected::{Counts, Member, Trouble};
pub use error::{FleetError, Result};
pub use listing::{entries, is_recording, shard, sources};
pub use one::diagnose_one;
pub use options::FleetOptions;
pub use part::Part;
pub use row::{Row, SCHEMA};
pub use run::{Observer, reference, run};
pub use socam_diagnose::Frozen;
pub use source::{Content, Source};
pub use summary::{Different, Faulty, Group, Machine, SUMMARY_SCHEMA, Spread, Summary, Survey, Trend};
pub use table::Table;
