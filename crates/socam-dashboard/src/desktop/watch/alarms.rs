//! The state of a watch and its alarms in words.

use egui::{RichText, Ui};
use socam_findings::words;
use socam_monitoring::{Alarm, Cause, Overlay, Phase, Verdict};

use socam_chart::theme;

/// Largest number of causes in the list.
const CAUSES: usize = 6;

/// Draws the phase of the monitoring and the amount of healthy data in its baseline.
pub(super) fn state(ui: &mut Ui, overlay: &Overlay, name: &str) {
    let (text, colour) = match overlay.phase {
        Phase::Learning { collected_s, needed_s } => {
            (format!("learning what is usual: {collected_s:.1} of {needed_s:.0} s"), theme::weak(ui))
        }
        Phase::Watching if overlay.judged == 0 && overlay.alarms.is_empty() => {
            (format!("nothing of {name} was judged yet"), theme::weak(ui))
        }
        Phase::Watching => (format!("{name} behaves as usual"), theme::good(ui)),
        Phase::Alarmed => (format!("{name} has changed"), theme::alarm(ui)),
    };
    ui.label(RichText::new(text).size(15.0).strong().color(colour));
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
    if overlay.not_judged > 0 {
        let text = format!(
            "{} blocks were not judged: more or less motion than in the healthy bench, or gaps",
            overlay.not_judged
        );
        ui.label(RichText::new(text).small().color(theme::weak(ui)));
    }
}

/// All alarms, the last one first.
pub(super) fn list(ui: &mut Ui, overlay: &Overlay, selected: &mut Option<usize>) {
    if overlay.alarms.is_empty() {
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

/// One line for the recording.
pub(super) fn sentence(alarm: &Alarm) -> String {
    let cause = alarm.naming.as_ref().filter(|naming| naming.verdict != Verdict::Unnamed);
    let causes = cause.map_or_else(String::new, |naming| {
        let names = naming.causes.iter().take(CAUSES).map(words_of);
        format!("; {}", names.collect::<Vec<_>>().join(" or "))
    });
    format!(
        "the bench left its model about {:.1} s before the alarm, most in {}: {}, {:.1} standard deviations{causes}",
        alarm.time_s - alarm.onset_s,
        alarm.channel,
        alarm.symptom,
        alarm.size_sigma
    )
}
