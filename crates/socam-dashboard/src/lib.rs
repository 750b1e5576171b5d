//! The dashboard: panels over plain state.
//!
//! [`Dashboard`] is everything that is shown; [`Dashboard::ui`] draws it into whatever window there is: the host's, a browser's, or none
//! ([`picture`] draws without a display, which is how reports and tests see it). Opening files and diagnosing run on
//! threads ([`job`]); a running bench is at the other end of two channels ([`live`]), so that no picture ever holds up a sample.
//!
//! SI inside, unit in the name.

mod about;
mod dashboard;
pub mod diagnosis;
pub mod document;
pub mod draw;
pub mod files;
mod headless;
pub mod help;
pub mod job;
mod layout;
pub mod live;
mod menu;
mod outside;
pub mod parameters;
pub mod recording;
pub mod review;
pub mod samples;
mod save;
pub mod spectra;
pub mod theme;

pub use dashboard::{Dashboard, Simulate};
pub use headless::{Viewport, picture};
pub use layout::{Layout, View};
