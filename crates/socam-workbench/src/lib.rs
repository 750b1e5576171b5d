//! State of a window on recordings, models and a running bench, without the window.
//!
//! Nothing here draws: no crate that this one is built from knows a window, and a test asserts it. A thread that has something new to
//! show calls a [`Wake`]. What is read by other crates, such as files of other programs, comes in by a plain function
//! ([`recording::Read`]), so that everything here also runs in a browser.

pub mod about;
pub mod align;
pub mod arrangement;
pub mod buffer;
pub mod computed;
pub mod connection;
pub mod cross_correlation;
pub mod derivation;
pub mod derivations;
pub mod device;
pub mod display_units;
pub mod document;
pub mod drive_run;
pub mod element;
pub mod entry;
pub mod histogram;
pub mod identification;
pub mod input_signal;
pub mod job;
pub mod link;
pub mod model_history;
pub mod motion;
pub mod new_model;
pub mod next_run;
pub mod origin;
pub mod purpose;
pub mod queue;
pub mod rail;
pub mod recording;
pub mod residual_test;
pub mod run;
pub mod save;
pub mod session;
pub mod setup;
pub mod signal;
pub mod spectrum_settings;
pub mod view;
pub mod watch;
pub mod workspace;

pub use job::Wake;
pub use view::View;
pub use workspace::{Content, Departure, Feed, Request, Simulate, Workspace};
