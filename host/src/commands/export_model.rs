//! `export-model`: a model file for a simulator.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::ValueEnum;
use socam_export::{Provenance, Target};
use socam_model::{
    EffectUse, Model,
    effects::{self, CONSTANT_LOAD, COULOMB_FRICTION, GRAVITY_UNBALANCE, LawInput},
};

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
  socam-host export-model two-mass --to modelica -o -
  socam-host export-model corrected.toml --into arm.xml --joint elbow -o corrected.xml")]
pub(crate) struct Args {
    #[arg(value_name = "MODEL", help = socam_job::MODEL_HELP)]
    model: String,
    /// Simulator
    #[arg(long, value_enum, required_unless_present = "into")]
    to: Option<To>,
    /// Description of a robot (URDF, MJCF or SDF) from which `import-model` took the model: its joint gets the model's numbers, and the rest of its text stays
    #[arg(long, value_name = "ROBOT", conflicts_with = "to", requires = "output")]
    into: Option<PathBuf>,
    /// Joint of ROBOT, needed where there are several
    #[arg(long, value_name = "NAME", requires = "into")]
    joint: Option<String>,
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
    if let Some(robot) = &args.into {
        return into_robot(&args, robot, &model);
    }
    let Some(target) = args.to.and_then(To::text) else { return unit(&args, &model) };
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

/// Puts the numbers of a joint's model into the description that it came from.
fn into_robot(args: &Args, path: &Path, model: &Model) -> anyhow::Result<Outcome> {
    let (robot, text) = super::import_model::open(path)?;
    let joint = robot.joint(args.joint.as_deref()).with_context(|| format!("`{}`", path.display()))?;
    require_same_joint(args, path, model, &joint)?;
    let (corrections, others) = corrections(model, &joint)?;
    let (patched, left_out) = socam_robot::patch(&text, &joint.name, joint.behind.value, &corrections)
        .with_context(|| format!("`{}`", path.display()))?;
    for part in left_out.iter().chain(&others) {
        output::warn(format_args!("{} does not hold all: {part}", robot.syntax));
    }
    let Some(target) = &args.output else {
        return Err(WrongArguments("name the description to write with -o".into()).into());
    };
    if target.as_os_str() == "-" {
        output::print(&patched)?;
        return Ok(Outcome::Done);
    }
    output::check_target(target, path, args.force)?;
    let mut file = output::create_new(target, args.force)?;
    file.write_all(patched.as_bytes()).with_context(|| format!("cannot write `{}`", target.display()))?;
    file.commit()?;
    output::say(format_args!("joint {} of {} written to {}", joint.name, joint.robot, target.display()));
    Ok(Outcome::Done)
}

/// Refuses the numbers of one joint for another.
fn require_same_joint(
    args: &Args,
    path: &Path,
    model: &Model,
    joint: &socam_robot::JointModel,
) -> anyhow::Result<()> {
    match model.nodes.as_slice() {
        [node] if node.name != joint.node() => {
            let problem = format!(
                "`{}` is a model of `{}`, and `{}` of `{}` is another joint; name the model's own with --joint, or call the model's node `{}`",
                args.model,
                node.name,
                joint.name,
                path.display(),
                joint.node()
            );
            Err(WrongArguments(problem).into())
        }
        _ => Ok(()),
    }
}

/// The parameter of the dry friction at speed: of Coulomb friction, or of a law that takes its place.
fn dry_friction(used: &EffectUse) -> Option<usize> {
    // A variant of a law has the law's id, and replaces that law alone.
    let law = effects::find(used.effect.id)?;
    let is_dry = law.id == COULOMB_FRICTION.id
        || law.replaces.iter().any(|simpler| simpler.law == COULOMB_FRICTION.id);
    let at = used.effect.parameters.iter().position(|parameter| parameter.name == "torque")?;
    is_dry.then_some(used.parameters[at])
}

/// The dry friction of a law of the file's own at speed, N m (N), where its other inputs are 0: what it takes either way, if that no longer
/// changes with the speed.
fn own_friction(model: &Model, used: &EffectUse) -> Option<f64> {
    let ([law], true) = (used.effect.laws(), used.effect.is_own()) else { return None };
    let values: Vec<f64> = used.parameters.iter().map(|index| model.parameters[*index].value).collect();
    let torque = |speed: f64| {
        let inputs = law.law_inputs.iter().map(|input| if *input == LawInput::Speed { speed } else { 0.0 });
        law.evaluate(&inputs.collect::<Vec<f64>>(), &values).torque
    };
    let [slow, fast] = [FAST, 2.0 * FAST].map(|speed| 0.5 * (torque(-speed) - torque(speed)));
    (fast > 0.0 && (fast - slow).abs() < 1e-3 * fast).then_some(fast)
}

/// A speed, rad/s (m/s), at which dry friction is that of motion.
const FAST: f64 = 20.0;

/// Whether a number is another but for its rounding in a file.
fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * a.abs()
}

/// The numbers of a model of one joint, and what is not among them, in sentences.
fn corrections(
    model: &Model,
    joint: &socam_robot::JointModel,
) -> anyhow::Result<(socam_robot::Corrections, Vec<String>)> {
    let [node] = model.nodes.as_slice() else {
        let problem = format!(
            "`{}` has {} nodes; a joint's model, as `import-model` writes it, has one",
            model.name,
            model.nodes.len()
        );
        return Err(WrongArguments(problem).into());
    };
    let value = |index: usize| model.parameters[index].value;
    let sum = |values: Vec<f64>| (!values.is_empty()).then(|| values.iter().sum());
    let damping = model.bearings.iter().filter_map(|bearing| bearing.damping).map(value).collect();
    let catalogued = model.effects.iter().filter_map(dry_friction).map(value);
    let friction: Vec<f64> =
        catalogued.chain(model.effects.iter().filter_map(|used| own_friction(model, used))).collect();
    let stiffness = model.springs.iter().map(|spring| value(spring.stiffness)).collect();
    let corrections = socam_robot::Corrections {
        inertia: node.inertia.map(value),
        damping: sum(damping),
        friction: sum(friction),
        stiffness: sum(stiffness),
    };
    // Weight is that of the bodies, and the rest of a spring stays where it is.
    let preload = joint.preload.as_ref().map(|preload| preload.value);
    let is_held = |used: &EffectUse| match used.effect.id {
        id if id == CONSTANT_LOAD.id => {
            !joint.turns || preload.is_some_and(|preload| is_same(preload, value(used.parameters[0])))
        }
        id => [COULOMB_FRICTION, GRAVITY_UNBALANCE].iter().any(|held| held.id == id),
    };
    let others = model.effects.iter().filter(|used| !is_held(used));
    let others = others.map(|used| {
        let part = match (dry_friction(used), own_friction(model, used)) {
            (Some(_), _) => ", of which it takes the dry friction at speed alone".to_owned(),
            (_, Some(friction)) => format!(
                ", of which it takes the dry friction at speed alone, {friction:.4} where all other inputs of the law are 0"
            ),
            _ => String::new(),
        };
        format!("{} at {}{part}", used.effect.name, used.place)
    });
    let others = others.collect();
    Ok((corrections, others))
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
