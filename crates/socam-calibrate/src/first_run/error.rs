//! What a first run cannot go on from.

use socam_recording::SettingsError;

/// What a first run cannot go on from, in one sentence.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FirstRunError {
    /// The run has too few samples.
    #[error(
        "the run has {0} samples in which the motor was driven; at least 200 are needed: is the supply on, and did a fault end it?"
    )]
    TooShort(usize),
    /// The encoder of the motor does not count.
    #[error(
        "the motor's encoder counted {counts:.0} while {volts:.1} V were applied: check its supply and its wires A and B, and that the motor \
         turned; a higher --volts turns a stiffer one"
    )]
    Silent {
        /// Counts in the whole run.
        counts: f64,
        /// Largest voltage of the run.
        volts: f64,
    },
    /// The encoder counts to both sides whatever the voltage is.
    #[error(
        "the {which} encoder counts up and down whatever the voltage is: one of its wires A and B is broken, or its shaft slips"
    )]
    NoDirection {
        /// "motor's" or "output's".
        which: &'static str,
    },
    /// No index, and no number.
    #[error(
        "the counts per turn of the motor's encoder are not known: its index was passed {passes} times; wire it to the first digital input, or \
         give --counts-per-turn (four times the lines; a data sheet's CPR often is that already)"
    )]
    NoIndex {
        /// Passes of the index.
        passes: usize,
    },
    /// The counts between two passes of the index differ.
    #[error(
        "the index was passed every {low:.1} to {high:.1} counts: counts are lost, or the first digital input sees another signal; check the \
         encoder's supply and pull-ups"
    )]
    IndexUneven {
        /// Fewest counts.
        low: f64,
        /// Most counts.
        high: f64,
    },
    /// The winding does not follow.
    #[error(
        "voltage, current and speed do not follow a winding: {ohm:.3} ohm and {v_s:.5} V s/rad were found; check shunt, amplifier and divider"
    )]
    NoWinding {
        /// Resistance.
        ohm: f64,
        /// V s/rad.
        v_s: f64,
    },
    /// The calibration cannot be edited.
    #[error(transparent)]
    Settings(#[from] SettingsError),
}
