//! `watch`: a recorded bench beside its model, with alarms.

use serde::Serialize;
use socam_recording::Dataset;
use socam_watch::{Alarm, Event, Summary, Watch};

use super::Outcome;
use crate::alarms::{self, WatchArgs};
use crate::{model_file, output};

/// Watch recordings against a model, and raise an alarm where the bench departs from it
///
/// A baseline is learned from recordings of the healthy bench, or from the beginning of each recording. The alarm says when the bench
/// changed, in which channel, and which cause explains it. Alarms are results: the exit code is 0 with alarms and without.
/// `record --watch` does the same while the bench runs.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host watch RUN.mcap --model bench.toml
  socam-host watch RUN.mcap --model bench.toml --baseline monday.mcap --baseline tuesday.mcap
  socam-host watch RUN.csv --model bench.toml --baseline RUN.csv@0..60 --false-alarms-per-hour 0.1 --json")]
pub(crate) struct Args {
    /// Recordings (.mcap, .csv or .m), or parts of them: RUN@FROM..TO in seconds
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<String>,
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = model_file::HELP)]
    model: String,
    #[command(flatten)]
    watch: WatchArgs,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let model = model_file::load(&args.model)?;
    let baseline = args.watch.baseline(&model)?;
    let mut outcome = Outcome::Done;
    let mut recordings = Vec::new();
    for run in &args.runs {
        let data = output::open_for(run, &model, socam_expectation::GRID_PARTS)?;
        if Outcome::on([&data]) == Outcome::LostSamples {
            outcome = Outcome::LostSamples;
        }
        let mut watch = Watch::new(&model, data.channels(), baseline.clone(), args.watch.settings())?;
        let mut watched = Watched { recording: data.name().to_owned(), ..Watched::default() };
        let mut events = watch.push_all(&data)?;
        events.extend(watch.finish()?);
        events.iter().for_each(|event| watched.take(event));
        let overlay = watch.overlay();
        watched.baseline = overlay.baseline;
        watched.blocks_not_judged = overlay.not_judged;
        if !args.json {
            output::print(&watched.text(&data, &events))?;
        }
        recordings.push(watched);
    }
    if args.json {
        output::print_json(&Document { schema: "socam.watch/1", model: &model.name, recordings })?;
    }
    Ok(outcome)
}

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    model: &'a str,
    recordings: Vec<Watched>,
}

#[derive(Default, Serialize)]
struct Watched {
    recording: String,
    /// `None` where the recording is too short to learn from.
    baseline: Option<Summary>,
    /// Blocks with more or less motion than the baseline, or with too few samples.
    blocks_not_judged: usize,
    alarms: Vec<Alarm>,
    /// Number of the alarm and time of its end, s.
    returned: Vec<(usize, f64)>,
}

impl Watched {
    fn take(&mut self, event: &Event) {
        match event {
            Event::Learned(summary) => alarms::say_baseline(summary),
            Event::Alarm(alarm) => self.alarms.push(alarm.clone()),
            Event::Named(alarm) => {
                if let Some(known) = self.alarms.iter_mut().find(|known| known.number == alarm.number) {
                    *known = alarm.clone();
                }
            }
            Event::Returned { number, time_s } => self.returned.push((*number, *time_s)),
        }
    }

    fn text(&self, data: &Dataset, events: &[Event]) -> String {
        let length_s = data.end_s() - data.start_s();
        let count = match (&self.baseline, self.alarms.len()) {
            (None, _) => {
                "too short to learn what is healthy: give --baseline, or a shorter --learn".to_owned()
            }
            (_, 0) => "no alarm".to_owned(),
            (_, 1) => "1 alarm".to_owned(),
            (_, many) => format!("{many} alarms"),
        };
        let mut text = format!("{}: {count} in {length_s:.1} s\n", self.recording);
        if self.blocks_not_judged > 0 {
            text += &format!(
                "  {} blocks were not judged: more or less motion than in the baseline, or too few samples\n",
                self.blocks_not_judged
            );
        }
        for event in events.iter().filter(|event| !matches!(event, Event::Learned(_))) {
            text += &format!("  {}\n", alarms::text(event));
        }
        text
    }
}
