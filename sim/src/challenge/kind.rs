//! Kinds of hidden effects, and the kind of each case.

use serde::{Deserialize, Serialize};

/// Kind of the hidden effects of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CaseKind {
    /// Nothing.
    Clean,
    /// One effect of the catalogue.
    Single,
    /// Two effects of the catalogue.
    Double,
    /// An effect outside the catalogue.
    Outside,
}

/// Kinds of twenty consecutive pairs of cases; the first of a pair has no background, the second one is realistic.
const KINDS: [CaseKind; 20] = {
    use CaseKind::{Clean, Double, Outside, Single};
    [
        Clean, Single, Double, Clean, Single, Outside, Clean, Single, Clean, Double, Single, Clean, Single,
        Clean, Outside, Single, Clean, Double, Single, Clean,
    ]
};

impl CaseKind {
    /// Kind of a case, and the number of pairs of the same kind before it.
    pub(super) fn turn(number: u64) -> (Self, u64) {
        let pair = number / 2;
        let (block, place) = (pair / KINDS.len() as u64, (pair % KINDS.len() as u64) as usize);
        let kind = KINDS[place];
        let among = |kinds: &[Self]| kinds.iter().filter(|other| **other == kind).count() as u64;
        (kind, block * among(&KINDS) + among(&KINDS[..place]))
    }

    /// Kind of a case.
    #[must_use]
    pub fn of(number: u64) -> Self {
        Self::turn(number).0
    }
}
