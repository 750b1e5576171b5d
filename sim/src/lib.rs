//! socam-sim.
