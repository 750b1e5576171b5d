//! `watch`: monitors recordings against a model and raises alarms.

use socam_job::{Grid, ModelSettings, Watch};
use socam_monitoring::{Document, Event, RecordingVerdict, Watched};
use socam_recording::Dataset;

use super::Outcome;
use crate::alarms::{self, WatchArgs};
use crate::output;
use crate::rules::{self, Kept, RulesArgs, WithRules};

/// Watch recordings against a model, and raise an alarm where the bench departs from it
///
/// A baseline is learned from recordings of the healthy bench, or from the beginning of each recording. The alarm says when the bench
/// changed, in which channel, and which cause explains it. Alarms are results: the exit code is 0 with alarms and without, and 4 if a rule of
/// `--rules` is broken.
/// `record --watch` does the same while the bench runs.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host watch RUN.mcap --model bench.toml
  socam-host watch RUN.mcap --model bench.toml --baseline monday.mcap --baseline tuesday.mcap
  socam-host watch RUN.csv --model bench.toml --baseline RUN.csv@0..60 --false-alarms-per-hour 0.1 --json")]
pub(crate) struct Args {
    #[arg(value_name = "RUN", required = true, help = output::RUNS_HELP)]
    runs: Vec<String>,
    #[command(flatten)]
    model: ModelSettings,
    #[command(flatten)]
    watch: WatchArgs,
    #[command(flatten)]
    rules: RulesArgs,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(mut args: Args) -> anyhow::Result<Outcome> {
    args.runs = output::expanded(&args.runs)?;
    let model = args.model.load()?;
    let baseline = args.watch.baseline(&model)?;
    let rules = args.rules.read()?;
    let mut kept = Vec::new();
    let task = Watch { model: args.model, watching: args.watch.watching };
    let mut outcome = Outcome::Done;
    let mut recordings = Vec::new();
    for run in &args.runs {
        let data = output::open_on(Grid::Even(&model), run)?;
        if Outcome::on([&data]) == Outcome::LostSamples {
            outcome = Outcome::LostSamples;
        }
        let (watched, events) = task.run(&model, baseline.clone(), &data)?;
        for event in &events {
            if let Event::Learned(summary) = event {
                alarms::say_baseline(summary);
            }
        }
        let judged = rules::judge(rules.as_ref(), &data)?;
        if !args.json {
            let rules = judged.as_ref().map_or_else(String::new, Kept::text);
            output::print(&(text(&watched, &data, &events) + &rules))?;
        }
        kept.extend(judged);
        recordings.push(watched);
    }
    if recordings.iter().any(|watched| watched.verdict == RecordingVerdict::NotJudged) {
        outcome = Outcome::NothingJudged;
    }
    if kept.iter().any(|kept| !kept.is_kept()) {
        outcome = Outcome::RuleBroken;
    }
    if args.json {
        output::print_json(&WithRules { document: Document::new(&model.name, recordings), rules: kept })?;
    }
    Ok(outcome)
}

fn text(watched: &Watched, data: &Dataset, events: &[Event]) -> String {
    let length_s = data.end_s() - data.start_s();
    let count = match (&watched.baseline, watched.alarms.len()) {
        (None, _) => "too short to learn what is healthy: give --baseline, or a shorter --learn".to_owned(),
        (_, 0) if watched.verdict == RecordingVerdict::NotJudged => "nothing was judged".to_owned(),
        (_, 0) => "no alarm".to_owned(),
        (_, 1) => "1 alarm".to_owned(),
        (_, many) => format!("{many} alarms"),
    };
    let mut text = format!("{}: {count} in {length_s:.1} s\n", watched.recording);
    if watched.blocks_not_judged > 0 {
        text += &format!(
            "  {} blocks were not judged: more or less motion than in the baseline, or too few samples\n",
            watched.blocks_not_judged
        );
    }
    for event in events.iter().filter(|event| !matches!(event, Event::Learned(_))) {
        text += &format!("  {}\n", alarms::text(event));
    }
    text
}
