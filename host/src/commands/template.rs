//! `template`: templates of files.

use clap::ValueEnum;
use socam_recording::{Calibration, ProfileFile};

use super::Outcome;
use crate::output;
use crate::output::WrongArguments;

/// Print a model, a calibration or a profile as a template for your own file
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host template model > bench.toml               the default bench's model
  socam-host template model two-mass > bench.toml
  socam-host template calibration > calibration.toml
  socam-host template calibration gearmotor > calibration.toml     of a gearmotor board; gearmotor-torque: with a torque transducer
  socam-host template profile chirp > profile.toml")]
pub(crate) struct Args {
    /// Kind of template
    kind: TemplateKind,
    /// Embedded model (speed-o-cam, two-mass, emps, emps-loop, gearmotor), calibration (gearmotor, gearmotor-torque) or built-in profile (`record --list-profiles`) [default: the default
    /// one of its kind]
    name: Option<String>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum TemplateKind {
    Model,
    Calibration,
    Profile,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let text = match (args.kind, args.name.as_deref()) {
        (TemplateKind::Model, name) => socam_job::model_text(name.unwrap_or("speed-o-cam"))?,
        (TemplateKind::Calibration, None) => Calibration::default_text().to_owned(),
        (TemplateKind::Calibration, Some("gearmotor")) => Calibration::gearmotor_text().to_owned(),
        (TemplateKind::Calibration, Some("gearmotor-torque")) => Calibration::gearmotor_torque_text(),
        (TemplateKind::Calibration, Some(name)) => {
            let problem = format!(
                "`{name}`: there are three calibrations to start from: `gearmotor`, `gearmotor-torque`, and the default bench's, which needs no name"
            );
            return Err(WrongArguments(problem).into());
        }
        (TemplateKind::Profile, name) => ProfileFile::open(name.unwrap_or("multisine"))?.to_toml(),
    };
    output::print(&text)?;
    Ok(Outcome::Done)
}
