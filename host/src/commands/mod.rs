//! The commands, one file each. A new one takes its `mod` line and its line in the table below.

mod calibrate;
mod challenge;
mod check;
mod compare;
mod completions;
#[cfg(feature = "dashboard")]
mod dashboard;
mod demo;
mod design;
mod diagnose;
mod efficiency;
mod export;
mod export_model;
mod flash;
mod fleet;
mod identify;
mod import;
mod info;
mod model;
mod new;
mod record;
mod recover;
mod simulate;
mod template;
mod thesis;
mod virtual_board;
mod watch;

use std::process::ExitCode;

use socam_recording::Dataset;

/// How a command that did not fail ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Done.
    Done,
    /// Done, but samples were lost, or a recording is damaged or cut off.
    LostSamples,
}

impl Outcome {
    /// Of a command that did its work on these recordings: whether they are cut off, damaged, or lack samples.
    pub(crate) fn on<'d>(recordings: impl IntoIterator<Item = &'d Dataset>) -> Self {
        if recordings.into_iter().all(Dataset::is_complete) { Self::Done } else { Self::LostSamples }
    }
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Done => Self::SUCCESS,
            Outcome::LostSamples => Self::from(3),
        }
    }
}

/// Makes the subcommands from `Name => module` lines. Each module has `Args` (whose doc comment is the command's help) and
/// `run(Args) -> anyhow::Result<Outcome>`.
macro_rules! commands {
    ($($(#[$condition:meta])* $name:ident => $module:ident,)*) => {
        #[derive(Debug, clap::Subcommand)]
        pub(crate) enum Command {
            $($(#[$condition])* $name($module::Args),)*
        }

        impl Command {
            /// Runs it.
            pub(crate) fn run(self) -> anyhow::Result<Outcome> {
                match self {
                    $($(#[$condition])* Self::$name(args) => $module::run(args),)*
                }
            }
        }
    };
}

commands! {
    Info => info,
    Check => check,
    Import => import,
    Export => export,
    ExportModel => export_model,
    Identify => identify,
    Diagnose => diagnose,
    Fleet => fleet,
    Compare => compare,
    Calibrate => calibrate,
    Efficiency => efficiency,
    Design => design,
    Demo => demo,
    Record => record,
    Watch => watch,
    Recover => recover,
    Simulate => simulate,
    Challenge => challenge,
    VirtualBoard => virtual_board,
    #[cfg(feature = "dashboard")]
    Dashboard => dashboard,
    Flash => flash,
    New => new,
    Model => model,
    Template => template,
    Thesis => thesis,
    Completions => completions,
}
