//! Names of channels, recorded or derived.

use serde::{Deserialize, Serialize};

/// Name and unit of a channel, recorded or derived.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Signal {
    /// Name without a unit.
    pub name: String,
    /// Symbol of its unit.
    pub unit: String,
}

impl Signal {
    /// `torque_out, N m`
    #[must_use]
    pub fn label(&self) -> String {
        format!("{}, {}", self.name, self.unit)
    }
}
