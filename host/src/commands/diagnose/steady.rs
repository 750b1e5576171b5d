//! `diagnose` of steady states: tables of operating points instead of recordings over time.

use std::io::Write;
use std::path::Path;

use socam_diagnose::{Evidence, SteadyOptions};
use socam_model::Model;
use socam_recording::{Format, Steady, detect};

use super::{Args, text};
use crate::commands::Outcome;
use crate::output::{self, WrongArguments};
use crate::provenance;

/// Whether the files are tables of steady states; a mixture is an error.
pub(super) fn are_named(args: &Args) -> anyhow::Result<bool> {
    let all: Vec<&String> = args.runs.iter().chain(&args.holdout).collect();
    let is_table = |run: &&&String| matches!(detect(Path::new(run)), Ok(Format::SteadyStates));
    let tables = all.iter().filter(is_table).count();
    if tables == 0 {
        if args.repeatability.is_some() {
            let message = "--repeatability is for tables of steady states; noise of recordings over time is found from them";
            return Err(WrongArguments(message.into()).into());
        }
        return Ok(false);
    }
    if tables < all.len() {
        let message = "tables of steady states and recordings over time are diagnosed apart: run it twice";
        return Err(WrongArguments(message.into()).into());
    }
    if !args.holdout.is_empty() {
        let message =
            "--holdout is for recordings over time; of steady states each point is left out in turn";
        return Err(WrongArguments(message.into()).into());
    }
    Ok(true)
}

pub(super) fn run(args: &Args, model: &Model) -> anyhow::Result<Outcome> {
    let mut options = SteadyOptions { false_alarm_rate: args.false_alarm_rate, ..SteadyOptions::default() };
    if let Some(repeatability) = args.repeatability {
        if !(repeatability > 0.0 && repeatability < 0.5) {
            let message = format!("--repeatability {repeatability}: expected a share between 0 and 0.5");
            return Err(WrongArguments(message).into());
        }
        options.repeatability = repeatability;
    }
    let target = args.write_model.as_deref().map(|path| output::create_new(path, args.force)).transpose()?;
    let open = |run: &String| {
        let table = Steady::open(Path::new(run))?;
        table.warnings.iter().for_each(|warning| output::warn(format_args!("`{run}`: {warning}")));
        Ok(table)
    };
    let tables = args.runs.iter().map(open).collect::<anyhow::Result<Vec<Steady>>>()?;
    let (diagnosis, model_toml) = socam_diagnose::diagnose_steady(model, &tables, options)?;
    if let Some(mut target) = target {
        target.write_all(model_toml.as_bytes())?;
        target.commit()?;
    }
    if let Some(dir) = &args.report {
        let made = provenance::of(&args.model, model, &args.runs)?;
        let model = (model, Some(model_toml.as_str()));
        socam_report::diagnosis::write(dir, &diagnosis, &Evidence::default(), model, &made)?;
    }
    if args.json {
        output::print_json(&diagnosis)?;
    } else {
        diagnosis.warnings.iter().for_each(output::warn);
        output::print(&text(&diagnosis))?;
    }
    Ok(Outcome::Done)
}
