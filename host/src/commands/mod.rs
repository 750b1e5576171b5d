//! The commands, one file each. A new command needs its `mod` line and its line in the table below.

mod calibrate;
#[cfg(feature = "challenge")]
mod challenge;
mod check;
mod compare;
mod completions;
#[cfg(feature = "window")]
mod dashboard;
mod demo;
mod design;
mod diagnose;
mod efficiency;
mod export;
#[cfg(feature = "exchange")]
mod export_model;
mod flash;
#[cfg(feature = "fleet")]
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
#[cfg(feature = "thesis")]
mod thesis;
mod virtual_board;
mod watch;

use std::process::ExitCode;

use socam_recording::Dataset;

/// Outcome of a command that did not fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Done.
    Done,
    /// Done, but samples were lost, or a recording is damaged or cut off.
    LostSamples,
    /// Done with the best answer so far: the search was ended before its own end, by its budget or by Ctrl-C.
    Unfinished,
    /// Done, but nothing could be judged: no channel in common, or no block like those of the baseline.
    NothingJudged,
}

impl Outcome {
    /// Outcome of a command that used these recordings: whether they are cut off, damaged, or lack samples.
    pub(crate) fn on<'d>(recordings: impl IntoIterator<Item = &'d Dataset>) -> Self {
        if recordings.into_iter().all(Dataset::is_complete) { Self::Done } else { Self::LostSamples }
    }

    /// The same where the search came to its own end. An answer that more time would change matters more than lost samples.
    pub(crate) fn of_search(self, is_finished: bool) -> Self {
        if is_finished { self } else { Self::Unfinished }
    }
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Done => Self::SUCCESS,
            Outcome::LostSamples => Self::from(3),
            Outcome::Unfinished => Self::from(4),
            Outcome::NothingJudged => Self::FAILURE,
        }
    }
}

/// Arguments of a command that this build leaves out: any, so that it says so whatever is typed.
#[cfg(not(all(
    feature = "window",
    feature = "fleet",
    feature = "exchange",
    feature = "challenge",
    feature = "thesis"
)))]
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub(crate) struct NotBuilt {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    _any: Vec<std::ffi::OsString>,
}

/// Error for a command, or an option of one, that this build leaves out.
#[cfg(not(all(
    feature = "window",
    feature = "fleet",
    feature = "exchange",
    feature = "challenge",
    feature = "thesis"
)))]
pub(crate) fn not_built(what: &str, feature: &str) -> anyhow::Error {
    anyhow::anyhow!(
        "{what} is not part of this build: build socam-host with its feature `{feature}`, or with all of them (`cargo install --path host`)"
    )
}

/// Makes the subcommands from lines `Name => module` or `Name => module if "feature"`. Each module has `Args` (whose doc comment is
/// the command's help) and `run(Args) -> anyhow::Result<Outcome>`. A command whose feature is off says which one it needs.
macro_rules! commands {
    ($($name:ident => $module:ident $(if $feature:literal)?,)*) => {
        #[derive(Debug, clap::Subcommand)]
        pub(crate) enum Command {
            $(
                $(#[cfg(feature = $feature)])?
                $name($module::Args),
                $(
                    #[cfg(not(feature = $feature))]
                    #[command(about = concat!("Not part of this build, which lacks the feature `", $feature, "`"))]
                    $name(NotBuilt),
                )?
            )*
        }

        impl Command {
            /// Runs the command.
            pub(crate) fn run(self) -> anyhow::Result<Outcome> {
                match self {
                    $(
                        $(#[cfg(feature = $feature)])?
                        Self::$name(args) => $module::run(args),
                        $(
                            #[cfg(not(feature = $feature))]
                            Self::$name(_) => {
                                let name = stringify!($module).replace('_', "-");
                                Err(not_built(&format!("`{name}`"), $feature))
                            }
                        )?
                    )*
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
    ExportModel => export_model if "exchange",
    Identify => identify,
    Diagnose => diagnose,
    Fleet => fleet if "fleet",
    Compare => compare,
    Calibrate => calibrate,
    Efficiency => efficiency,
    Design => design,
    Demo => demo,
    Record => record,
    Watch => watch,
    Recover => recover,
    Simulate => simulate,
    Challenge => challenge if "challenge",
    VirtualBoard => virtual_board,
    Dashboard => dashboard if "window",
    Flash => flash,
    New => new,
    Model => model,
    Template => template,
    Thesis => thesis if "thesis",
    Completions => completions,
}
