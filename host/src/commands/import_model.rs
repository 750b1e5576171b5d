//! `import-model`: a joint of a robot's description as a model file.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use socam_robot::Robot;

use super::Outcome;
use crate::output;

/// Make a model file of one joint of a robot that URDF, MJCF (MuJoCo) or SDF describes
///
/// Inertia and weight of everything behind the joint are summed up with the other joints at zero; damping, friction, armature, spring and
/// gear are the description's. Each number says where it comes from, and what the model leaves out is listed. `export-model --into` puts the
/// corrected numbers back.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host import-model arm.xml                                   lists the joints, or writes the only one
  socam-host import-model arm.xml --joint elbow -o elbow.toml
  socam-host diagnose run.csv --model elbow.toml --write-model corrected.toml
  socam-host export-model corrected.toml --into arm.xml --joint elbow -o corrected.xml")]
pub(crate) struct Args {
    /// Description: .urdf, .xml or .sdf
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,
    /// Joint, needed where there are several
    #[arg(long, value_name = "NAME")]
    joint: Option<String>,
    /// Model file to write; `-` for stdout [default: JOINT.toml]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let (robot, _) = open(&args.robot)?;
    let path = args.robot.display();
    let joint = robot.joint(args.joint.as_deref()).with_context(|| format!("`{path}`"))?;
    let name = args.robot.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let text = joint.model_file(&name);
    for left_out in &joint.left_out {
        output::warn(format_args!("left out: {left_out}"));
    }
    let target = args.output.clone().unwrap_or_else(|| PathBuf::from(&joint.name).with_extension("toml"));
    if target.as_os_str() == "-" {
        output::print(&text)?;
        return Ok(Outcome::Done);
    }
    output::check_target(&target, &args.robot, args.force)?;
    let mut file = output::create_new(&target, args.force)?;
    file.write_all(text.as_bytes()).with_context(|| format!("cannot write `{}`", target.display()))?;
    file.commit()?;
    let target = target.display();
    output::say(format_args!(
        "{target} written: the joint {} of {} ({}); see it with `socam-host model show {target}`",
        joint.name, joint.robot, robot.syntax
    ));
    Ok(Outcome::Done)
}

/// A robot, and the text of its description.
pub(super) fn open(path: &Path) -> anyhow::Result<(Robot, String)> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read `{}`", path.display()))?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let include = |file: &str| std::fs::read_to_string(folder.join(file)).ok();
    let robot = Robot::parse(&text, &include).with_context(|| format!("`{}`", path.display()))?;
    Ok((robot, text))
}
