//! Other nodes of a bus than the one that is recorded, for what is said where that one is silent.

use std::collections::BTreeSet;

/// Most numbers that are kept.
const MOST: usize = 16;

/// Numbers of the nodes that were heard.
#[derive(Debug, Default)]
pub(super) struct Others(BTreeSet<u32>);

impl Others {
    pub(super) fn heard(&mut self, node: u32) {
        if self.0.len() < MOST {
            self.0.insert(node);
        }
    }

    /// Their numbers in words; `None` if there are none.
    pub(super) fn names(&self) -> Option<String> {
        let names: Vec<String> = self.0.iter().map(u32::to_string).collect();
        (!names.is_empty()).then(|| names.join(", "))
    }
}
