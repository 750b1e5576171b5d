//! socam-recording.
