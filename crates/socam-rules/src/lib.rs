//! Rules of one's own: what a formula over the channels of a recording must keep to, and for how long it may not.
//!
//! [`Rules`] is the file, [`Judge`] a set of rules bound to the channels of a recording, [`Verdict`] what it says of one rule.

mod error;
mod file;
mod judge;

pub use error::RulesError;
pub use file::{Rule, Rules, SCHEMA};
pub use judge::{Episode, Judge, Keeping, Verdict};
