//! socam-model.
