//! Alarms as text, and the options of monitoring.

use std::fmt::Write;

use socam_job::{Grid, Watching};
use socam_model::Model;
use socam_monitoring::{Alarm, Baseline, Cause, Event, Naming, Summary, Verdict};

use crate::output;

/// How a bench is watched
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct WatchArgs {
    /// Recording of the healthy bench, or a part of it: RUN@FROM..TO in seconds or clock times; may be repeated [default: the beginning of what is watched]
    #[arg(long, value_name = "HEALTHY", num_args = 1..)]
    pub(crate) baseline: Vec<String>,
    #[command(flatten)]
    pub(crate) watching: Watching,
}

impl WatchArgs {
    /// Whether any option but the rate was given.
    pub(crate) fn is_set(&self) -> bool {
        !self.baseline.is_empty() || self.watching.is_set()
    }

    /// Computes the baseline of the healthy recordings, if any are given, and prints its summary.
    pub(crate) fn baseline(&self, model: &Model) -> anyhow::Result<Option<Baseline>> {
        let healthy = output::open_all(Grid::Even(model), &output::expanded(&self.baseline)?)?;
        let baseline = self.watching.baseline(model, &healthy)?;
        baseline.iter().for_each(|baseline| say_baseline(baseline.summary()));
        Ok(baseline)
    }
}

/// Prints what a baseline supports, and a warning if it is short.
pub(crate) fn say_baseline(summary: &Summary) {
    output::say(format_args!("{}", baseline(summary)));
    if summary.is_short {
        output::warn(format_args!(
            "{} blocks are few: the rate of false alarms is uncertain; record the healthy bench for a few minutes",
            summary.blocks
        ));
    }
}

/// `baseline: 30.0 s of the healthy bench, 60 blocks, 14 statistics; ...`
fn baseline(summary: &Summary) -> String {
    let Summary { healthy_s, blocks, statistics, false_alarms_per_hour: rate, .. } = summary;
    let mut text = format!(
        "baseline: {healthy_s:.1} s of the healthy bench, {blocks} blocks, {statistics} statistics, thresholds for {rate} false alarms per hour"
    );
    if *rate < summary.observed_down_to_per_hour {
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            " (extrapolated: so much healthy data shows {:.1} per hour directly)",
            summary.observed_down_to_per_hour
        );
    }
    text
}

/// An event in one line or more.
pub(crate) fn text(event: &Event) -> String {
    match event {
        Event::Learned(summary) => baseline(summary),
        Event::Alarm(alarm) => alarm_text(alarm),
        Event::Named(alarm) => {
            let causes = alarm.naming.as_ref().map_or_else(
                || "the model cannot be evaluated on the samples after the change".to_owned(),
                naming_text,
            );
            format!("cause of alarm {}: {causes}", alarm.number)
        }
        Event::Returned { number, time_s } => {
            format!("alarm {number} has ended: at {time_s:.3} s the bench is as before")
        }
    }
}

fn alarm_text(alarm: &Alarm) -> String {
    let Alarm { number, time_s, onset_s, channel, size_sigma, symptom, .. } = alarm;
    format!(
        "alarm {number} at {time_s:.3} s: {channel} departs from the model since about {onset_s:.3} s ({symptom} {size_sigma:+.1} standard \
         deviations of a healthy block)"
    )
}

fn naming_text(naming: &Naming) -> String {
    let [from_s, to_s] = naming.window_s;
    let listed: Vec<String> = naming.causes.iter().map(cause_text).collect();
    let listed = listed.join("; ");
    let over = format!("from {from_s:.1} to {to_s:.1} s");
    match naming.verdict {
        Verdict::Named => format!("{listed}; {over}"),
        Verdict::Tied => format!("one of these: {listed}; {over}"),
        Verdict::Unnamed => format!("unnamed: no effect stands out {over}"),
    }
}

/// `coulomb_friction at load_bearing (torque 0.31), 97 %`
fn cause_text(cause: &Cause) -> String {
    let values: Vec<String> =
        cause.amplitude.iter().map(|(name, value)| format!("{name} about {value:.3}")).collect();
    let place = if cause.effect == "parameter" { "" } else { " at " };
    let what = if place.is_empty() { "change of ".to_owned() } else { cause.effect.clone() };
    format!("{what}{place}{} ({}), {:.0} %", cause.location, values.join(", "), 100.0 * cause.share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_monitoring::Symptom;

    #[test]
    fn an_alarm_is_one_sentence() {
        let cause = |effect: &str, location: &str, share| Cause {
            effect: effect.into(),
            location: location.into(),
            amplitude: vec![("torque".into(), 0.3111)],
            gain: 100.0,
            p_value: 1e-3,
            share,
        };
        let causes = vec![cause("coulomb_friction", "load_bearing", 0.75), cause("parameter", "c5", 0.25)];
        let alarm = Alarm {
            number: 2,
            time_s: 42.5,
            onset_s: 40.0,
            symptom: Symptom::Power("torque_out".into()),
            channel: "torque_out".into(),
            size_sigma: 2.34,
            naming: Some(Naming { verdict: Verdict::Tied, window_s: [40.0, 50.0], causes }),
        };
        assert_eq!(
            text(&Event::Alarm(alarm.clone())),
            "alarm 2 at 42.500 s: torque_out departs from the model since about 40.000 s (power of the error of torque_out +2.3 standard \
             deviations of a healthy block)"
        );
        assert_eq!(
            text(&Event::Named(alarm)),
            "cause of alarm 2: one of these: coulomb_friction at load_bearing (torque about 0.311), 75 %; change of c5 (torque about \
             0.311), 25 %; from 40.0 to 50.0 s"
        );
    }
}
