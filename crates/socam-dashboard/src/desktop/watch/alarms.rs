//! The state of a watch and its alarms in words.

use egui::{RichText, Ui};
use socam_findings::words;
use socam_monitoring::{Alarm, Cause, Judgement, Overlay, Phase, Verdict};

use socam_chart::theme;
use socam_plot::words::counted;
use socam_workbench::watch::{Tone, WatchState};

/// Largest number of causes in the list.
const CAUSES: usize = 6;

/// What is said about the health of what is watched, and how it is coloured.
fn judgement(overlay: &Overlay, name: &str) -> (String, Tone) {
    let all = overlay.judged + overlay.not_judged;
    let share = if overlay.not_judged == 0 {
        String::new()
    } else {
        format!(" in {} of {all} blocks; the others were not judged", overlay.judged)
    };
    match overlay.judgement() {
        Judgement::Learning => match overlay.phase {
            Phase::Learning { collected_s, needed_s } => {
                (format!("learning what is usual: {collected_s:.1} of {needed_s:.0} s"), Tone::Quiet)
            }
            Phase::Watching | Phase::Alarmed => ("learning what is usual".into(), Tone::Quiet),
        },
        Judgement::NotJudged if all == 0 => (format!("{name}: nothing was judged yet"), Tone::Quiet),
        Judgement::NotJudged => {
            (format!("{name}: not judged, none of {}", counted(all, "block", "blocks")), Tone::Quiet)
        }
        Judgement::NotJudgedNow => {
            (format!("{name}: not judged at present; as usual before{share}"), Tone::Quiet)
        }
        Judgement::AsUsual if overlay.alarms.is_empty() => {
            (format!("{name} behaves as usual{share}"), Tone::Good)
        }
        Judgement::AsUsual => (
            format!("{name} is back to usual after {}", counted(overlay.alarms.len(), "alarm", "alarms")),
            Tone::Good,
        ),
        Judgement::Changed => (format!("{name} has changed"), Tone::Alarm),
    }
}

/// The same in a few words, for all views and the title of the window.
pub(super) fn summary(overlay: &Overlay) -> WatchState {
    let (text, tone) = match (overlay.judgement(), overlay.alarms.len()) {
        (_, alarms) if alarms > 0 => (counted(alarms, "alarm", "alarms"), Tone::Alarm),
        (Judgement::Learning, _) => ("learning".into(), Tone::Quiet),
        (Judgement::AsUsual, _) => ("as usual".into(), Tone::Good),
        _ => ("not judged".into(), Tone::Quiet),
    };
    WatchState { text, tone }
}

/// Draws the judgement and the amount of healthy data in its baseline.
pub(super) fn state(ui: &mut Ui, overlay: &Overlay, name: &str) {
    let (text, tone) = judgement(overlay, name);
    let colour = match tone {
        Tone::Quiet => theme::body(ui),
        Tone::Good => theme::good(ui),
        Tone::Alarm => theme::alarm(ui),
    };
    ui.add(egui::Label::new(RichText::new(text).size(15.0).strong().color(colour)).wrap());
    if overlay.not_judged > 0 {
        let text = format!(
            "{} not judged: more or less motion than in the healthy bench, or gaps. Take a healthy recording of the same motion, or a longer one.",
            counted(overlay.not_judged, "block was", "blocks were")
        );
        ui.add(egui::Label::new(RichText::new(text).color(theme::alarm(ui))).wrap());
    }
    if let Some(baseline) = &overlay.baseline {
        let text = format!(
            "{} statistics; usual is what {:.0} s of the healthy bench show; thresholds for {} false alarms per hour",
            baseline.statistics, baseline.healthy_s, baseline.false_alarms_per_hour
        );
        ui.label(RichText::new(text).small().color(theme::weak(ui)));
        if baseline.is_short {
            let text = format!(
                "The healthy recordings are short for that rate: alarms down to {:.2} per hour were observed directly; less rests on extrapolation.",
                baseline.observed_down_to_per_hour
            );
            ui.label(RichText::new(text).small().color(theme::alarm(ui)));
        }
    }
}

/// All alarms, the last one first.
pub(super) fn list(ui: &mut Ui, overlay: &Overlay, selected: &mut Option<usize>) {
    // That there is no alarm says nothing where nothing was judged.
    if overlay.alarms.is_empty() && overlay.judged > 0 {
        ui.label(RichText::new("no alarm").color(theme::weak(ui)));
    }
    for alarm in overlay.alarms.iter().rev() {
        ui.add_space(6.0);
        let is_selected = *selected == Some(alarm.number);
        let title = format!("Alarm {} at {:.2} s", alarm.number, alarm.time_s);
        if ui.selectable_label(is_selected, RichText::new(title).strong().color(theme::alarm(ui))).clicked() {
            *selected = (!is_selected).then_some(alarm.number);
        }
        let text = format!(
            "changed at about {:.2} s, most in {}; {}: {:.1} standard deviations",
            alarm.onset_s, alarm.channel, alarm.symptom, alarm.size_sigma
        );
        ui.add(egui::Label::new(text).wrap());
        causes(ui, alarm);
    }
}

fn causes(ui: &mut Ui, alarm: &Alarm) {
    let Some(naming) = &alarm.naming else {
        ui.label(RichText::new("the cause is being sought").small().color(theme::weak(ui)));
        return;
    };
    ui.label(RichText::new(verdict(naming.verdict)).small().color(theme::weak(ui)));
    for cause in naming.causes.iter().take(CAUSES) {
        let text = format!("{}: {:.0} %", words_of(cause), 100.0 * cause.share);
        ui.label(RichText::new(text).strong());
    }
}

fn words_of(cause: &Cause) -> String {
    match cause.effect.as_str() {
        "parameter" => format!("a change of {}", cause.location),
        effect => format!("{} at {}", words::effect(effect), cause.location),
    }
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Named => "one cause explains it best:",
        Verdict::Tied => "several causes explain it as well:",
        Verdict::Unnamed => "no effect of the catalogue and no parameter explains it",
    }
}

/// One line for every view.
pub(super) fn notice(alarm: &Alarm) -> String {
    format!(
        "Alarm {} at {:.1} s: the bench departs from its model since about {:.1} s, most in {}",
        alarm.number, alarm.time_s, alarm.onset_s, alarm.channel
    )
}

/// One line for the recording.
pub(super) fn sentence(alarm: &Alarm) -> String {
    let cause = alarm.naming.as_ref().filter(|naming| naming.verdict != Verdict::Unnamed);
    let causes = cause.map_or_else(String::new, |naming| {
        let names = naming.causes.iter().take(CAUSES).map(words_of);
        format!("; {}", names.collect::<Vec<_>>().join(" or "))
    });
    format!(
        "the bench departed from its model about {:.1} s before the alarm, most in {}: {}, {:.1} standard deviations{causes}",
        alarm.time_s - alarm.onset_s,
        alarm.channel,
        alarm.symptom,
        alarm.size_sigma
    )
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use socam_monitoring::BlockSignals;

    use super::*;

    fn overlay(judged: usize, not_judged: usize, tests: Vec<f64>) -> Overlay {
        let (time_s, measured, model, innovations) = (vec![0.0], Vec::new(), Vec::new(), Vec::new());
        Overlay {
            phase: Phase::Watching,
            channels: Arc::default(),
            statistics: Arc::default(),
            blocks: vec![Arc::new(BlockSignals { time_s, measured, model, innovations, tests })],
            alarms: Vec::new(),
            baseline: None,
            judged,
            not_judged,
        }
    }

    /// Only blocks that were judged say that a bench is as usual.
    #[test]
    fn what_was_not_judged_is_not_called_usual() {
        let (text, tone) = judgement(&overlay(0, 80, Vec::new()), "run.mcap");
        assert_eq!((text.as_str(), tone), ("run.mcap: not judged, none of 80 blocks", Tone::Quiet));
        assert_eq!(summary(&overlay(0, 80, Vec::new())).text, "not judged");
        let resting = overlay(5, 80, Vec::new());
        assert!(judgement(&resting, "run.mcap").0.starts_with("run.mcap: not judged at present"));
        assert_eq!(summary(&resting), WatchState { text: "not judged".into(), tone: Tone::Quiet });
        let (text, tone) = judgement(&overlay(20, 60, vec![0.2]), "run.mcap");
        let said = "run.mcap behaves as usual in 20 of 80 blocks; the others were not judged";
        assert_eq!((text.as_str(), tone), (said, Tone::Good));
        assert_eq!(judgement(&overlay(80, 0, vec![0.2]), "run.mcap").0, "run.mcap behaves as usual");
        assert_eq!(summary(&overlay(80, 0, vec![0.2])).text, "as usual");
    }
}
