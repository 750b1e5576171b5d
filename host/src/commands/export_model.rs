//! `export-model`: a model file for a simulator.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::ValueEnum;
use socam_export::{Provenance, Target};
use socam_model::Model;

use super::Outcome;
use crate::output::{self, WrongArguments};

/// Hand a model back to a simulator: MuJoCo, URDF, SDF, Modelica, Simscape, MATLAB, Python or an FMI 3.0 unit
///
/// The file holds the model's values with their intervals and sources. What the simulator's format cannot hold is listed by name in the file
/// and on stderr; a model of which no motion would be right is refused.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host export-model corrected.toml --to mujoco                writes corrected.xml
  socam-host export-model corrected.toml --to python -o bench.py
  socam-host export-model corrected.toml --to fmi3                  writes corrected.fmu
  socam-host export-model two-mass --to modelica -o -")]
pub(crate) struct Args {
    #[arg(value_name = "MODEL", help = socam_job::MODEL_HELP)]
    model: String,
    /// Simulator
    #[arg(long, value_enum)]
    to: To,
    /// File to write; `-` for stdout [default: beside MODEL, with the simulator's extension]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum To {
    Mujoco,
    Urdf,
    Sdf,
    Modelica,
    Simscape,
    Matlab,
    Python,
    /// A functional mock-up unit (FMI 3.0, co-simulation)
    Fmi3,
}

impl To {
    /// The target that is a text; `None` for a unit.
    fn text(self) -> Option<Target> {
        Some(match self {
            Self::Mujoco => Target::Mujoco,
            Self::Urdf => Target::Urdf,
            Self::Sdf => Target::Sdf,
            Self::Modelica => Target::Modelica,
            Self::Simscape => Target::Simscape,
            Self::Matlab => Target::Matlab,
            Self::Python => Target::Python,
            Self::Fmi3 => return None,
        })
    }
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let model = socam_job::load_model(&args.model)?;
    let Some(target) = args.to.text() else { return unit(&args, &model) };
    let path = args.output.unwrap_or_else(|| beside(&args.model, target));
    let to_stdout = path.as_os_str() == "-";
    let name = name(&args.model, &path, target)?;
    // Whether the file may be written is checked before the work.
    let file = if to_stdout {
        None
    } else {
        output::check_target(&path, Path::new(&args.model), args.force)?;
        Some(output::create_new(&path, args.force)?)
    };
    let file_name = Path::new(&args.model)
        .file_name()
        .map_or(args.model.clone(), |own| own.to_string_lossy().into_owned());
    let exported = socam_export::export(&model, &Provenance::new(&file_name, &model.text), target, &name)?;
    for part in &exported.left_out {
        output::warn(format_args!("{} does not hold all: {part}", target.name()));
    }
    match file {
        None => output::print(&exported.text)?,
        Some(mut file) => {
            file.write_all(exported.text.as_bytes())
                .with_context(|| format!("cannot write `{}`", path.display()))?;
            file.commit()?;
            output::say(format_args!("{} written to {}", model.name, path.display()));
        }
    }
    Ok(Outcome::Done)
}

/// Packs an FMI unit with the shared library that cargo builds next to this program.
fn unit(args: &Args, model: &Model) -> anyhow::Result<Outcome> {
    let default = || Path::new(&args.model).with_extension("fmu");
    let path = args.output.clone().unwrap_or_else(default);
    if path.as_os_str() == "-" {
        return Err(
            WrongArguments("a unit is an archive and is not printed; name a file with -o".into()).into()
        );
    }
    output::check_target(&path, Path::new(&args.model), args.force)?;
    let bytes = socam_fmu::fmu(&model.text)?;
    let mut file = output::create_new(&path, args.force)?;
    file.write_all(&bytes).with_context(|| format!("cannot write `{}`", path.display()))?;
    file.commit()?;
    output::say(format_args!("{} written to {}", model.name, path.display()));
    Ok(Outcome::Done)
}

/// The default path: beside the model file, with a name that the simulator finds.
fn beside(model: &str, target: Target) -> PathBuf {
    let model = Path::new(model);
    let stem = model.file_stem().map_or_else(|| "model".into(), |stem| stem.to_string_lossy());
    let stem = if target.is_found_by_name() { socam_export::identifier(&stem) } else { stem.into_owned() };
    model.with_file_name(stem).with_extension(target.extension())
}

/// The name that the file defines.
fn name(model: &str, path: &Path, target: Target) -> Result<String, WrongArguments> {
    if path.as_os_str() == "-" {
        return Ok(Path::new(model)
            .file_stem()
            .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()));
    }
    let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let identifier = socam_export::identifier(&stem);
    if target.is_found_by_name() && identifier != stem {
        return Err(WrongArguments(format!(
            "`{}`: {} finds a file by the name that it defines, and {stem} can be none; name it {identifier}.{}",
            path.display(),
            target.name(),
            target.extension()
        )));
    }
    Ok(identifier)
}
