//! socam-core.
#![no_std]
