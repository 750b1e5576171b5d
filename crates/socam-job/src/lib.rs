//! The tasks of all front ends. Each has its settings, a way to open its recordings, a run and a result.
//!
//! A task is a struct of settings: [`Check`], [`Identify`], [`Response`], [`Diagnose`], [`Compare`], [`Watch`], [`Simulate`], [`Design`],
//! [`FleetRow`] and [`Record`]. Only the struct describes the task's options: the command line flattens it, [`options::from_keywords`]
//! reads it from keywords, [`options::describe`] describes its form for a window, and [`options::command_line`] writes it as a command. A
//! task runs on a model and on recordings in memory; [`Grid`] opens them as the task needs their samples. Results have
//! `document()`, the JSON contract.
//!
//! A new option is a field of one struct here. Nothing here prints.

mod check;
mod compare;
mod design;
mod diagnose;
mod error;
mod fleet;
mod grid;
mod identify;
pub mod inputs;
mod model;
pub mod notation;
pub mod options;
mod record;
mod response;
pub mod rules;
mod simulate;
mod tasks;
mod watch;

pub use check::Check;
pub use compare::{Compare, Compared};
pub use design::{Design, Designed, Rival};
pub use diagnose::{Diagnose, Diagnosed, HeldOutRecording, OpenRecording};
pub use error::{JobError, Result};
pub use fleet::FleetRow;
pub use grid::Grid;
pub use identify::{Calibrated, Identified, Identify, Method, NOT_OVER_FREQUENCY, fitted};
pub use model::{MODEL_HELP, ModelSettings, load_model, model_text};
pub use options::Settings;
pub use record::Record;
pub use response::{Response, Responses, Signals};
pub use rules::Start;
pub use simulate::{ReplayDocument, Replayed, Simulate, VirtualBench};
pub use tasks::{described, words};
pub use watch::{Watch, Watching};
