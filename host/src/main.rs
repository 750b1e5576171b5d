//! socam-host.
fn main() {}
