//! socam-wire.
#![no_std]
