//! The limits and the input signal of a drive that is commanded, in the panel at the left.

use egui::{Button, CollapsingHeader, ComboBox, DragValue, Label, RichText, Ui};

use socam_chart::theme;
use socam_core::State;
use socam_recording::{ProfileCommand, ProfileFile};
use socam_workbench::connection::Connection;
use socam_workbench::device::{Effort, Offer};
use socam_workbench::drive_run::{DriveRun, FORMS, SLEW};
use socam_workbench::input_signal::SignalShape;

use super::fields::profile;
use super::parts::{Action, card};

/// Largest limits that can be set: speed, rad/s; torque, N m; current, A.
const MOST_RAD_S: f64 = 2000.0;
const MOST_NM: f64 = 1000.0;
const MOST_A: f64 = 1000.0;

/// Whether limits and signal may be changed: nothing is armed.
fn is_at_rest(bench: &Connection) -> bool {
    !matches!(bench.state(), Some(State::Armed | State::Running | State::Stopping))
}

/// The limits, what the drive keeps to and what it does not promise.
pub(super) fn limits(ui: &mut Ui, bench: &Connection, offer: &Offer, run: &mut DriveRun) {
    card(ui, "Limits of the run", |ui| {
        ui.add_enabled_ui(is_at_rest(bench), |ui| {
            let mut speed_rad_s = run.speed_rad_s();
            field(ui, "Largest speed", &mut speed_rad_s, MOST_RAD_S, "rad/s");
            if speed_rad_s != run.speed_rad_s() {
                run.set_speed(speed_rad_s);
            }
            let most = if offer.effort == Effort::Torque { MOST_NM } else { MOST_A };
            let name = format!("Largest {}", offer.effort.name());
            let mut effort = run.effort(offer.effort);
            field(ui, &name, &mut effort, most, offer.effort.unit());
            if effort != run.effort(offer.effort) {
                run.set_effort(offer.effort, effort);
            }
        });
        let rpm = run.speed_rad_s() * 30.0 / std::f64::consts::PI;
        let text = match run.limits(offer.effort) {
            None => {
                "Set both: without them nothing is armed. The run ends when the drive reports more.".into()
            }
            Some(_) => format!("{rpm:.0} rpm at most. The run ends when the drive reports more."),
        };
        sentence(ui, &text, false);
        if !offer.kept.is_empty() && !is_at_rest(bench) {
            ui.label(RichText::new("The drive itself keeps to").small().strong());
            offer.kept.iter().for_each(|kept| sentence(ui, kept, false));
        }
        ui.label(RichText::new("Not promised").small().strong());
        offer.not_promised.iter().for_each(|not| sentence(ui, not, true));
        sentence(
            ui,
            "A drive whose own program hangs stops by its supply alone: have an emergency stop.",
            true,
        );
        CollapsingHeader::new(RichText::new("The same in a terminal").small()).show(ui, |ui| {
            ui.add(Label::new(RichText::new(&offer.command).monospace().size(12.0)).wrap());
            let hint = "Copy the command; disconnect before you run it";
            if ui.add(Button::new("Copy")).on_hover_text(hint).clicked() {
                ui.ctx().copy_text(offer.command.clone());
            }
        });
    });
}

fn sentence(ui: &mut Ui, text: &str, is_warning: bool) {
    let colour = if is_warning { theme::body(ui) } else { theme::weak(ui) };
    ui.add(Label::new(RichText::new(socam_chart::numbers::plain(text)).small().color(colour)).wrap());
}

/// A limit; 0 is shown as not set.
fn field(ui: &mut Ui, name: &str, value: &mut f64, most: f64, unit: &str) {
    ui.horizontal(|ui| {
        crate::together::level(ui);
        let label = ui.label(name);
        let suffix = format!(" {unit}");
        let speed = 0.01 * value.max(1.0);
        let drag = DragValue::new(value).speed(speed).range(0.0..=most).max_decimals(4);
        let drag = drag.custom_formatter(move |value, _| {
            if value > 0.0 { format!("{}{suffix}", (value * 1e4).round() / 1e4) } else { "not set".into() }
        });
        let unit = unit.to_owned();
        let drag = drag.custom_parser(move |text| {
            text.trim().trim_end_matches(unit.as_str()).trim().replace(',', ".").parse().ok()
        });
        ui.add(drag).labelled_by(label.id).on_hover_text(format!("0 to {most}; drag, or click and type"));
    });
}

/// The input signal of a drive: a form of speeds around standstill or of torques around zero, or a profile that was opened.
pub(super) fn signal(ui: &mut Ui, bench: &Connection, run: &DriveRun) -> Option<Action> {
    let mut settings = run.signal.settings.clone();
    let (mut chosen, mut is_torque) = (None, run.is_torque());
    ui.add_enabled_ui(is_at_rest(bench), |ui| {
        ui.horizontal(|ui| {
            ui.label("Commands");
            let tip = "A torque has no controller of speed: the motor turns as its load lets it, and the run ends beyond the largest speed";
            ui.selectable_value(&mut is_torque, false, "speed");
            ui.selectable_value(&mut is_torque, true, "torque").on_hover_text(tip);
        });
        ui.horizontal(|ui| {
            crate::together::level(ui);
            let label = ui.label("Signal");
            let shown = ComboBox::from_id_salt("signal").selected_text(settings.name()).width(180.0);
            let answer = shown.show_ui(ui, |ui| {
                for name in FORMS {
                    let is_it = matches!(&settings.kind, SignalShape::Other(own, _) if own == name);
                    if ui.selectable_label(is_it, name).clicked() {
                        chosen = Some(name);
                    }
                }
            });
            answer.response.labelled_by(label.id).on_hover_text(
                "Forms around standstill, or zero; File, Open takes any profile of speeds or torques",
            );
        });
        if let SignalShape::Other(_, file) = &mut settings.kind {
            let purpose = file.purpose.clone().unwrap_or_else(|| "an opened profile".into());
            ui.add(Label::new(RichText::new(purpose).small()).wrap());
            profile(ui, file);
            acceleration(ui, file);
        }
    });
    if is_torque != run.is_torque() {
        return Some(Action::Torques(is_torque));
    }
    let changed = (settings != run.signal.settings).then_some(Action::Change(settings));
    chosen.map(Action::Load).or(changed)
}

fn acceleration(ui: &mut Ui, file: &mut ProfileFile) {
    ui.horizontal(|ui| {
        crate::together::level(ui);
        let is_torque = file.command == ProfileCommand::Torque;
        let (name, suffix) = if is_torque { ("Rate", " N m/s") } else { ("Acceleration", " rad/s²") };
        let label = ui.label(name);
        let [low, high] = SLEW;
        let speed = 0.01 * file.slew.max(1.0);
        let drag = DragValue::new(&mut file.slew).speed(speed).suffix(suffix).range(low..=high).max_decimals(3);
        let hint = "The largest of the signal: what would be steeper is made as steep as this. A moteus is told an acceleration as its own limit too";
        ui.add(drag).labelled_by(label.id).on_hover_text(hint);
    });
}
