//! What a device does not state itself: options that say it, and a file that is asked for once.

use std::path::PathBuf;

use socam_sources::text::Found;
use socam_sources::{Description, SourceError};

use crate::output;

/// Options of devices other than the own board.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct SourceArgs {
    /// File that says what a device's lines hold: names, units, clock. If there is none, it is written, with a question mark for all that
    /// the device does not state; complete it and record again. For a drive with CANopen, the list of its objects
    #[arg(long, value_name = "D.toml")]
    pub(crate) describe: Option<PathBuf>,
    /// Take units that names suggest without asking, and leave out signals whose names suggest none
    #[arg(long)]
    pub(crate) accept_guesses: bool,
    /// DBC that says what the frames of a CAN bus hold
    #[arg(long, value_name = "FILE.dbc")]
    pub(crate) dbc: Option<PathBuf>,
    /// Whether they come from the window, whose fields are then named instead of options.
    #[arg(skip)]
    pub(crate) is_of_window: bool,
}

impl SourceArgs {
    /// How a description is given: "by --describe FILE".
    pub(super) fn by_description(&self) -> &'static str {
        if self.is_of_window { "in the field Description" } else { "by --describe FILE" }
    }

    /// How a DBC is given.
    #[cfg(feature = "formats-can")]
    pub(super) fn by_dbc(&self) -> &'static str {
        if self.is_of_window { "in the field DBC" } else { "by --dbc FILE" }
    }
}

/// A description with its text.
pub(super) struct Described {
    pub(super) read: Description,
    pub(super) text: String,
}

/// The description of a file, or of what was heard; a file that is missing is written.
pub(super) fn described(
    args: &SourceArgs,
    name: &str,
    found: impl Fn(bool) -> socam_sources::Result<Found>,
    check: impl Fn(&Description) -> anyhow::Result<()>,
) -> anyhow::Result<Described> {
    if let Some(file) = args.describe.as_deref().filter(|file| file.exists()) {
        let read = Description::open(file)?;
        check(&read)?;
        return Ok(Described { read, text: socam_recording::read_text(file)? });
    }
    let found = found(args.accept_guesses).map_err(|error| anyhow::anyhow!("{name}: {error}"))?;
    let read = found.description();
    if let Some(file) = &args.describe {
        output::write_whole(file, &found.text)?;
        output::say(format_args!("wrote `{}`", file.display()));
    }
    match read {
        Ok(read) => {
            check(&read)?;
            say_found(&found);
            Ok(Described { read, text: found.text })
        }
        Err(error @ SourceError::Unstated { .. }) => {
            let todo = match &args.describe {
                Some(file) => format!("replace each \"?\" in `{}`, and record again", file.display()),
                None if args.is_of_window => "name its description in the field below the address".into(),
                None => format!(
                    "name a file {}, which is written for you to complete, or take the likeliest by --accept-guesses",
                    args.by_description()
                ),
            };
            anyhow::bail!("{name}: {error}: {todo}")
        }
        Err(error) => anyhow::bail!("{name}: {error}"),
    }
}

fn say_found(found: &Found) {
    for assumed in &found.assumed {
        output::warn(format_args!("not stated by the device: {assumed}"));
    }
}
