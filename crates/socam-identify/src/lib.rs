//! socam-identify.
