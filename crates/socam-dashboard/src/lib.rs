//! The dashboard: panels over plain state.
//!
//! [`Dashboard`] holds the state; [`Dashboard::ui`] draws it into a window of the host or of a browser, and [`picture`] draws it without
//! a display, for reports and tests. Files are opened and diagnoses made on threads ([`job`]). A running bench is connected by
//! channels and a queue of samples ([`live`]), so that drawing never delays sampling.
//!
//! SI inside, unit in the name.

mod about;
pub mod check;
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
mod view;
mod workspace;

pub use dashboard::{Dashboard, Simulate};
pub use headless::{Viewport, picture};
pub use layout::Layout;
pub use view::{Help, View, ViewPanel, Views};
pub use workspace::{Request, Workspace};
