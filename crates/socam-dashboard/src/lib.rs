//! The dashboard: panels over plain state.
//!
//! [`Dashboard`] holds the state; [`Dashboard::ui`] draws it into a window of the host or of a browser, and [`picture`] draws it without
//! a display, for reports and tests. Files are opened and diagnoses made on threads ([`job`]). A running bench is connected by
//! channels and a queue of samples ([`live`]), so that drawing never delays sampling.
//!
//! SI inside, unit in the name.

mod about;
pub mod check;
mod commands;
mod dashboard;
pub mod diagnosis;
pub mod document;
pub mod files;
#[cfg(not(target_arch = "wasm32"))]
pub mod fitting;
#[cfg(not(target_arch = "wasm32"))]
pub mod fleet;
#[cfg(not(target_arch = "wasm32"))]
mod foreign;
mod headless;
pub mod help;
pub mod identify;
pub mod job;
mod layout;
pub mod live;
mod menu;
#[cfg(not(target_arch = "wasm32"))]
mod native;
mod outside;
pub mod parameters;
pub mod recording;
pub mod review;
mod save;
pub mod spectra;
mod view;
#[cfg(not(target_arch = "wasm32"))]
pub mod watch;
mod workspace;

pub use dashboard::{Dashboard, Simulate};
pub use headless::{Viewport, picture};
pub use layout::Layout;
pub use view::{Help, View, ViewPanel, Views};
pub use workspace::{Content, Feed, Request, Workspace};
