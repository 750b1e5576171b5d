//! The dashboard: views over the state of a [`socam_workbench`].
//!
//! [`Dashboard`] holds the state; [`Dashboard::ui`] draws it into a window of the host or of a browser, and [`picture`] draws it without
//! a display, for reports and tests.
//!
//! What a desktop has and a browser lacks (a bench, fits, files of other programs, dialogs) is in the folder `desktop`; `web` is what the
//! page does instead. One of the two is the module [`platform`], and no other file asks where it runs.

mod bench;
mod commands;
mod dashboard;
mod departure;
mod headless;
mod layout;
mod model_choice;
mod progress;
mod together;
mod view;

pub mod check;
pub mod diagnosis;
pub mod help;
pub mod identification;
pub mod machine;
pub mod review;
pub mod spectra;

#[cfg_attr(not(target_arch = "wasm32"), path = "desktop/mod.rs")]
#[cfg_attr(target_arch = "wasm32", path = "web/mod.rs")]
pub mod platform;

pub use dashboard::Dashboard;
pub use headless::{Viewport, picture, picture_by_own_fonts};
pub use layout::Layout;
pub use platform::Views;
pub use progress::wake;
pub use socam_workbench::{Simulate, View};
pub use view::{Help, ViewPanel};
