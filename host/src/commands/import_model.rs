//! `import-model`: a joint of a robot, or an axis of a controller, as a model file.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use clap::ValueEnum;
use socam_robot::{Controller, Robot, SysId};

use super::Outcome;
use crate::output::{self, WrongArguments};

/// Make a model file of a robot's joint (URDF, MJCF, SDF), of an axis by the settings of its moteus or ODrive, or of gains of WPILib's SysId
///
/// Of a joint, inertia and weight of everything behind it are summed up with the other joints at zero; damping, friction, armature, spring and
/// gear are the description's. Of an axis, torque constant, winding, gear, gains and limits are the settings'. Each number says where it comes
/// from, and what the model leaves out is listed. `export-model --into` puts a joint's corrected numbers back.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host import-model arm.xml                                   lists the joints, or writes the only one
  socam-host import-model arm.xml --joint elbow -o elbow.toml
  socam-host import-model moteus.cfg -o axis.toml                   from `moteus_tool --dump-config`
  socam-host import-model odrive.json --joint axis0 --drive reference   from `odrivetool backup-config`
  socam-host import-model --sysid \"ks=0.12 kv=0.8 ka=0.03 unit=rotations\"
  socam-host import-model --sysid \"ks=0.2 kv=1.5 ka=0.1 kg=0.4 unit=radians mechanism=arm\"
  socam-host diagnose run.csv --model elbow.toml --write-model corrected.toml
  socam-host export-model corrected.toml --into arm.xml --joint elbow -o corrected.xml")]
pub(crate) struct Args {
    /// Description of a robot (.urdf, .xml, .sdf), or settings of a controller (moteus: lines, ODrive: JSON)
    #[arg(value_name = "ROBOT|SETTINGS", required_unless_present = "sysid")]
    source: Option<PathBuf>,
    /// Joint of a robot, or axis of an ODrive, needed where there are several
    #[arg(long, value_name = "NAME")]
    joint: Option<String>,
    /// What drives the model of a controller's axis: the motor's current, its voltage, or the reference of the position loop [default: current]
    #[arg(long, value_enum)]
    drive: Option<Drive>,
    /// Gains of SysId: ks, kv, ka, unit (rotations, radians, degrees, meters, feet, inches), and for mechanism=elevator or arm kg
    #[arg(long, value_name = "GAINS", conflicts_with_all = ["source", "joint", "drive"])]
    sysid: Option<String>,
    /// Model file to write; `-` for stdout [default: JOINT.toml]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Drive {
    Current,
    Voltage,
    Reference,
}

impl From<Drive> for socam_robot::Drive {
    fn from(drive: Drive) -> Self {
        match drive {
            Drive::Current => Self::Current,
            Drive::Voltage => Self::Voltage,
            Drive::Reference => Self::Reference,
        }
    }
}

/// A model file before it is written.
struct Imported {
    name: String,
    text: String,
    left_out: Vec<String>,
    /// What it is, for a message.
    what: String,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let imported = import(&args)?;
    for left_out in &imported.left_out {
        output::warn(format_args!("left out: {left_out}"));
    }
    let target = args.output.unwrap_or_else(|| PathBuf::from(&imported.name).with_extension("toml"));
    if target.as_os_str() == "-" {
        output::print(&imported.text)?;
        return Ok(Outcome::Done);
    }
    output::check_target(&target, args.source.as_deref().unwrap_or(Path::new("")), args.force)?;
    let mut file = output::create_new(&target, args.force)?;
    file.write_all(imported.text.as_bytes())
        .with_context(|| format!("cannot write `{}`", target.display()))?;
    file.commit()?;
    let target = target.display();
    output::say(format_args!(
        "{target} written: {}; see it with `socam-host model show {target}`",
        imported.what
    ));
    Ok(Outcome::Done)
}

fn import(args: &Args) -> anyhow::Result<Imported> {
    if let Some(gains) = &args.sysid {
        let gains = SysId::parse(gains).map_err(|error| WrongArguments(error.to_string()))?;
        let what = format!("{} by gains of SysId", gains.name());
        return Ok(Imported {
            name: gains.name().to_owned(),
            text: gains.model_file(),
            left_out: gains.left_out(),
            what,
        });
    }
    let path = args.source.as_deref().unwrap_or(Path::new(""));
    let text = read(path)?;
    let file = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let named = || format!("`{}`", path.display());
    if !text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
        return axis(args, &text, &file).with_context(named);
    }
    if args.drive.is_some() {
        return Err(
            WrongArguments("a joint of a robot is driven by a torque; leave out --drive".into()).into()
        );
    }
    let robot = parse(path, &text)?;
    let joint = robot.joint(args.joint.as_deref()).with_context(named)?;
    Ok(Imported {
        text: joint.model_file(&file),
        what: format!("the joint {} of {} ({})", joint.name, joint.robot, robot.syntax),
        name: joint.name,
        left_out: joint.left_out,
    })
}

/// The axis of a controller's settings.
fn axis(args: &Args, text: &str, file: &str) -> socam_robot::Result<Imported> {
    let axis = Controller::parse(text, args.joint.as_deref())?;
    let (text, left_out) = axis.model_file(file, args.drive.unwrap_or(Drive::Current).into())?;
    Ok(Imported {
        what: format!("{} by settings of its {}", axis.name, axis.program),
        name: axis.name,
        text,
        left_out,
    })
}

/// A robot, and the text of its description.
pub(super) fn open(path: &Path) -> anyhow::Result<(Robot, String)> {
    let text = read(path)?;
    Ok((parse(path, &text)?, text))
}

fn read(path: &Path) -> anyhow::Result<String> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read `{}`", path.display()))?;
    String::from_utf8(bytes).map_err(|_| {
        let problem = "no description of a robot (URDF, MJCF, SDF) and no settings of a controller, which are text in UTF-8; \
                       `import` reads recordings";
        anyhow!("`{}`: {problem}", path.display())
    })
}

fn parse(path: &Path, text: &str) -> anyhow::Result<Robot> {
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let include = |file: &str| std::fs::read_to_string(folder.join(file)).ok();
    Robot::parse(text, &include).with_context(|| format!("`{}`", path.display()))
}
