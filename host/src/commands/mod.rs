//! The commands, one file each. A new command needs its `mod` line and its line in the table below.

mod align;
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
mod devices;
mod diagnose;
mod efficiency;
mod export;
#[cfg(feature = "exchange")]
mod export_model;
mod first_run;
mod flash;
#[cfg(feature = "fleet")]
mod fleet;
mod identify;
mod import;
#[cfg(feature = "exchange")]
mod import_model;
mod info;
#[cfg(feature = "agents")]
mod mcp;
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

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use socam_recording::{Dataset, OutputFile};

use crate::interrupt::{INTERRUPTED, Interrupt};
use crate::output;

/// Outcome of a command that did not fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Done.
    Done,
    /// Done, but samples were lost, or a recording is damaged or cut off.
    LostSamples,
    /// Ctrl-C ended the search. The best answer so far was printed, and no model was written.
    Interrupted,
    /// Done, and a rule of `--rules` was broken, or could not be judged.
    RuleBroken,
    /// Done, but nothing could be judged: no channel in common, or no block like those of the baseline.
    NothingJudged,
}

impl Outcome {
    /// Outcome of a command that used these recordings: whether they are cut off, damaged, or lack samples.
    pub(crate) fn on<'d>(recordings: impl IntoIterator<Item = &'d Dataset>) -> Self {
        if recordings.into_iter().all(Dataset::is_complete) { Self::Done } else { Self::LostSamples }
    }

    /// The same, unless Ctrl-C ended the search. A search that its budget ended has an answer like any other.
    pub(crate) fn unless_interrupted(self, is_interrupted: bool) -> Self {
        if is_interrupted { Self::Interrupted } else { self }
    }
}

/// The file of `--write-model`, which is created before a search, so that an error is reported before it.
struct ModelFile<'p> {
    path: &'p Path,
    file: OutputFile,
    interrupt: Interrupt,
}

impl<'p> ModelFile<'p> {
    /// Creates it under its temporary name. An interrupt that ends the process at once removes it.
    fn create(path: &'p Path, force: bool, interrupt: &Interrupt) -> anyhow::Result<Self> {
        let file = output::create_new(path, force)?;
        interrupt.unfinished(file.temporary());
        Ok(Self { path, file, interrupt: interrupt.clone() })
    }

    /// Writes the model of a search. One that was interrupted writes none, and leaves an earlier file as it was.
    fn write(mut self, text: &str, is_interrupted: bool) -> anyhow::Result<()> {
        if is_interrupted {
            output::warn(format_args!(
                "`{}` was not written, because the search was interrupted",
                self.path.display()
            ));
            drop(self.file);
        } else {
            self.file.write_all(text.as_bytes())?;
            self.file.commit()?;
        }
        self.interrupt.unfinished(None);
        Ok(())
    }
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Done => Self::SUCCESS,
            Outcome::LostSamples => Self::from(3),
            Outcome::RuleBroken => Self::from(4),
            Outcome::Interrupted => Self::from(INTERRUPTED),
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
    feature = "thesis",
    feature = "agents"
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
    feature = "thesis",
    feature = "agents"
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
    ImportModel => import_model if "exchange",
    ExportModel => export_model if "exchange",
    Identify => identify,
    Diagnose => diagnose,
    Fleet => fleet if "fleet",
    Compare => compare,
    Align => align,
    Calibrate => calibrate,
    Efficiency => efficiency,
    Design => design,
    Demo => demo,
    Devices => devices,
    Record => record,
    Watch => watch,
    Mcp => mcp if "agents",
    Recover => recover,
    Simulate => simulate,
    Challenge => challenge if "challenge",
    VirtualBoard => virtual_board,
    Dashboard => dashboard if "window",
    Flash => flash,
    FirstRun => first_run,
    New => new,
    Model => model,
    Template => template,
    Thesis => thesis if "thesis",
    Completions => completions,
}
