//! `model`: a look at a model file.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use socam_model::{Channel, ChannelTransform, Model, Parameter, Role};

use super::Outcome;
use crate::{output, table};

/// Look at a model: its drawing, parameters and channels
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host model show axis.toml
  socam-host model show speed-o-cam -o bench.svg")]
pub(crate) struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Print the drawing, the parameters and the channels of a model
    Show(Show),
}

#[derive(Debug, clap::Args)]
struct Show {
    #[arg(value_name = "MODEL", help = socam_job::MODEL_HELP)]
    model: String,
    /// Also write the drawing as a picture
    #[arg(short, long, value_name = "FILE.svg")]
    output: Option<PathBuf>,
    /// Longest line of the drawing, characters
    #[arg(long, value_name = "CHARACTERS", default_value_t = 110)]
    width: usize,
    /// Replace an existing picture
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let Action::Show(show) = args.action;
    if let Some(path) = show.output.iter().find(|path| path.extension().is_none_or(|e| e != "svg")) {
        let problem = format!("`{}`: the drawing is written as .svg", path.display());
        return Err(output::WrongArguments(problem).into());
    }
    let target = show.output.as_deref().map(|path| output::create_new(path, show.force)).transpose()?;
    let model = socam_job::load_model(&show.model)?;
    output::print(&text(&model, show.width))?;
    for warning in model.warnings() {
        output::warn(warning);
    }
    if let (Some(mut target), Some(path)) = (target, &show.output) {
        target
            .write_all(socam_report::bench::svg(&model, &[]).as_bytes())
            .with_context(|| format!("cannot write `{}`", path.display()))?;
        target.commit()?;
        output::say(format_args!("drawing written to {}", path.display()));
    }
    Ok(Outcome::Done)
}

fn text(model: &Model, width: usize) -> String {
    let mut text = model.name.clone();
    if !model.description.is_empty() {
        text += &format!(": {}", model.description);
    }
    text += &format!("\n\n{}\n  {}\n", socam_builder::draw(model, width), socam_builder::legend());
    let head = |cells: &[&str]| cells.iter().map(|cell| (*cell).to_owned()).collect::<Vec<_>>();
    let mut rows = vec![head(&["parameter", "value", "unit", "bounds", "", "source"])];
    rows.extend(model.parameters.iter().map(parameter));
    text += &format!("\n{}", table::align(&rows, &[false, true, false, false, false, false]));
    if !model.effects.is_empty() {
        let mut rows = vec![head(&["effect", "at"])];
        rows.extend(model.effects.iter().map(|used| vec![used.effect.id.to_owned(), used.place.clone()]));
        text += &format!("\n{}", table::align(&rows, &[false, false]));
    }
    let mut rows = vec![head(&["channel", "", "at", "column", "SI value"])];
    rows.extend(model.channels.iter().filter(|channel| !channel.quantity.is_clock()).map(channel));
    text + &format!("\n{}", table::align(&rows, &[false, false, false, false, false]))
}

/// A row of a parameter, in the file's unit.
fn parameter(own: &Parameter) -> Vec<String> {
    let number = |value: f64| table::short(value / own.file_factor);
    let bound = |value: f64| if value.is_finite() { number(value) } else { String::new() };
    let bounds = match own.bounds {
        (low, high) if low.is_infinite() && high.is_infinite() => String::new(),
        (low, high) => format!("{} .. {}", bound(low), bound(high)),
    };
    let fixed = if own.fixed { "fixed" } else { "" };
    vec![own.name.clone(), number(own.value), own.file_unit.clone(), bounds, fixed.into(), own.source.clone()]
}

fn channel(own: &Channel) -> Vec<String> {
    let role = if own.role == Role::Input { "input" } else { "output" };
    let quantity = format!("{:?}", own.quantity).to_lowercase();
    let scale = if own.scale == 1.0 { String::new() } else { format!("{} ", table::short(own.scale)) };
    let offset = if own.offset == 0.0 { String::new() } else { format!(" + {}", table::short(own.offset)) };
    let taken = match own.transform {
        ChannelTransform::Value | ChannelTransform::Elapsed | ChannelTransform::Integral => "x".to_owned(),
        ChannelTransform::Rate => "dx/dt".to_owned(),
        ChannelTransform::Cos(order) => format!("cos({order} x)"),
        ChannelTransform::Sin(order) => format!("sin({order} x)"),
    };
    let plain = own.scale == 1.0 && own.offset == 0.0 && own.transform == ChannelTransform::Value;
    let value = if plain { own.unit.to_owned() } else { format!("{scale}{taken}{offset} {}", own.unit) };
    vec![own.name.clone(), format!("{role} {quantity}"), own.at.clone(), own.column.clone(), value]
}
