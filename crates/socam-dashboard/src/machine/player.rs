//! What is played: the recording, the moment, the speed, the scale of angles, and the quantity of the colours.

use egui::{Button, ComboBox, Label, RichText, Role, Slider, Ui, WidgetInfo, vec2};
use socam_chart::theme;
use socam_workbench::entry::Entry;
use socam_workbench::motion::Motion;
use socam_workbench::recording::{Recording, short};

use super::motions::Motions;
use super::time_line;
use crate::together::{keep, together};

/// The quantity that colours the elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Colouring {
    /// No colours.
    #[default]
    None,
    /// How far the prediction is from the channel there.
    Misfit,
    /// Torque of springs.
    Torque,
    /// Power of springs.
    Power,
}

impl Colouring {
    const ALL: [Self; 4] = [Self::None, Self::Misfit, Self::Torque, Self::Power];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::None => "nothing",
            Self::Misfit => "misfit",
            Self::Torque => "torque",
            Self::Power => "power",
        }
    }
}

/// Scales of the angle; 0 chooses one.
const SCALES: [f64; 7] = [0.0, 100.0, 10.0, 1.0, 0.1, 0.01, 0.001];
/// Range of the speed of playing.
const SPEEDS: std::ops::RangeInclusive<f64> = 0.01..=10.0;
/// Longest step of a frame, s of the window's clock: a window that stood still does not leap.
const LONGEST_STEP_S: f32 = 0.1;
/// Angle per second of the fastest part that the eye follows, rad: half a turn.
const EASY_RAD_S: f64 = std::f64::consts::PI;
/// Angle to which the greatest travel of a part that hardly moves is enlarged, rad.
const SEEN_RAD: f64 = 1.5;

/// What is played, and how.
#[derive(Debug, Clone)]
pub struct Player {
    /// The moment that is drawn, s.
    pub time_s: f64,
    /// Whether time goes on.
    pub plays: bool,
    /// Seconds of the recording for a second of the clock.
    pub speed: f64,
    /// Drawn angle for an angle of the machine; 0 chooses one by the speed.
    pub scale: f64,
    /// The quantity that colours the elements.
    pub colouring: Colouring,
    /// Name of the recording; the first that is shown where there is none of that name.
    recording: Option<String>,
    /// The recording whose time was taken last.
    of: Option<String>,
}

impl Default for Player {
    fn default() -> Self {
        Self {
            time_s: f64::NEG_INFINITY,
            plays: false,
            speed: 1.0,
            scale: 0.0,
            colouring: Colouring::None,
            recording: None,
            of: None,
        }
    }
}

impl Player {
    /// The recording that is played: the chosen one, or the first that is shown.
    pub(super) fn choose(&mut self, entries: &[Entry]) -> Option<Recording> {
        let named = |entry: &&Entry| Some(&entry.recording.about.name) == self.recording.as_ref();
        let entry = entries.iter().find(named).or_else(|| entries.iter().find(|entry| entry.shown))?;
        let recording = entry.recording.clone();
        let [from, to] = recording.samples.span_s()?;
        if self.of.as_ref() != Some(&recording.about.name) {
            self.of = Some(recording.about.name.clone());
            self.plays = false;
        }
        // A moment that was asked for before the recording was open is kept.
        if !(from..=to).contains(&self.time_s) {
            self.time_s = self.time_s.clamp(from, to);
        }
        Some(recording)
    }

    /// Drawn angle for an angle of the machine.
    #[must_use]
    pub(super) fn angle_scale(&self, motion: &Motion) -> f64 {
        if self.scale > 0.0 {
            return self.scale;
        }
        let slow = nice(EASY_RAD_S / (motion.fastest * self.speed).max(1e-12));
        let large = nice(SEEN_RAD / motion.farthest.max(1e-12)).max(1.0);
        slow.min(large)
    }

    /// Goes on by the time since the last frame; at the end it begins anew.
    fn go_on(&mut self, ui: &Ui, [from, to]: [f64; 2]) {
        if !self.plays {
            return;
        }
        let step_s = ui.input(|input| input.stable_dt.min(LONGEST_STEP_S));
        self.time_s += f64::from(step_s) * self.speed;
        if self.time_s > to {
            self.time_s = from;
        }
        ui.ctx().request_repaint();
    }

    /// Draws the controls and the time line; true when an animation is asked for.
    pub(super) fn ui(
        &mut self,
        ui: &mut Ui,
        entries: &[Entry],
        recording: &Recording,
        motions: &mut Motions,
    ) -> bool {
        let mut films = false;
        let span_s = recording.samples.span_s().unwrap_or([0.0, 1.0]);
        self.go_on(ui, span_s);
        ui.horizontal_wrapped(|ui| {
            let word = if self.plays { "Pause" } else { "Play" };
            if ui.add(Button::new(RichText::new(word).strong()).min_size(vec2(58.0, 0.0))).clicked() {
                self.plays = !self.plays;
            }
            if ui.button("To the start").clicked() {
                self.time_s = span_s[0];
            }
            keep(ui, "Speed", 150.0);
            let label = ui.label("Speed");
            let slider = Slider::new(&mut self.speed, SPEEDS).logarithmic(true).suffix("×").fixed_decimals(2);
            ui.add(slider).labelled_by(label.id);
            if motions.known().is_none_or(|motion| motion.rotates) {
                self.scales(ui, motions.known());
            }
            self.colours(ui, motions);
            self.recordings(ui, entries, recording);
        });
        let text = match (motions.problem(), motions.is_busy()) {
            (Some(problem), _) => RichText::new(problem).color(theme::alarm(ui)),
            (None, true) => {
                RichText::new("simulating the model with the inputs of this recording").color(theme::weak(ui))
            }
            (None, false) => RichText::new(said(motions.known())).color(theme::weak(ui)),
        };
        ui.horizontal_wrapped(|ui| {
            if motions.can_be_predicted() && ui.button("Predict").clicked() {
                motions.predict();
            }
            ui.add(Label::new(text).wrap());
        });
        time_line::ui(ui, recording, span_s, &mut self.time_s);
        ui.horizontal(|ui| {
            ui.label(RichText::new(format!("{:.3} s", self.time_s)).monospace());
            let [from, to] = span_s;
            let whole = format!("of {from:.3} s to {to:.3} s");
            ui.label(RichText::new(whole).color(theme::weak(ui)).small());
            films = motions.known().is_some() && ui.button("Save animation...").clicked();
        });
        films
    }

    fn scales(&mut self, ui: &mut Ui, motion: Option<&Motion>) {
        let auto = motion.map_or_else(String::new, |motion| {
            let automatic = Self { scale: 0.0, ..self.clone() };
            format!(", {}", times(automatic.angle_scale(motion)))
        });
        let title = |scale: f64| if scale > 0.0 { times(scale) } else { format!("auto{auto}") };
        together(ui, "Angle", 104.0, |ui| {
            let list = ComboBox::from_id_salt("angle").width(96.0).selected_text(title(self.scale));
            list.show_ui(ui, |ui| {
                for scale in SCALES {
                    ui.selectable_value(&mut self.scale, scale, title(scale));
                }
            })
        });
    }

    fn colours(&mut self, ui: &mut Ui, motions: &Motions) {
        let is_predicted =
            motions.known().is_some_and(|motion| !motion.misfits.is_empty() || !motion.springs.is_empty());
        together(ui, "Colour by", 80.0, |ui| {
            let list = ComboBox::from_id_salt("colour").width(72.0).selected_text(self.colouring.name());
            list.show_ui(ui, |ui| {
                for colouring in Colouring::ALL {
                    let can = is_predicted || colouring == Colouring::None;
                    let choice = Button::selectable(self.colouring == colouring, colouring.name());
                    let choice = ui.add_enabled(can, choice);
                    if choice.on_disabled_hover_text("needs a prediction of the model").clicked() {
                        self.colouring = colouring;
                    }
                }
            })
        });
    }

    fn recordings(&mut self, ui: &mut Ui, entries: &[Entry], recording: &Recording) {
        if entries.len() < 2 {
            return;
        }
        keep(ui, "", 158.0);
        let list = ComboBox::from_id_salt("played").width(150.0).selected_text(short(&recording.about.name));
        let list = list.show_ui(ui, |ui| {
            for entry in entries {
                let name = &entry.recording.about.name;
                if ui.selectable_label(*name == recording.about.name, short(name)).clicked() {
                    self.recording = Some(name.clone());
                }
            }
        });
        list.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, "Played recording"));
    }
}

/// What is drawn, in words.
fn said(motion: Option<&Motion>) -> String {
    let Some(motion) = motion else { return String::new() };
    let [own, weak, other] =
        if motion.rotates { ["Spokes", "thin", "Hollow needles"] } else { ["Dots", "grey", "Rings"] };
    let is_predicted = motion.nodes.iter().any(|node| node.predicted.is_some());
    let rest = if is_predicted { format!("{other}: predicted.") } else { "Nothing is predicted.".into() };
    format!("{own}: measured ({weak} where the nearest sensor is beyond a spring). {rest}")
}

/// A scale as text: `×10`, `1/50`.
pub(super) fn times(scale: f64) -> String {
    if scale < 1.0 { format!("1/{:.0}", 1.0 / scale) } else { format!("×{scale:.0}") }
}

/// The greatest of 1, 2, 5, 10, ... (and their inverses) that is not above a value.
fn nice(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let step = [5.0, 2.0, 1.0].into_iter().find(|step| step * decade <= value * (1.0 + 1e-9)).unwrap_or(1.0);
    (step * decade).clamp(1e-6, 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_round_and_read_well() {
        assert_eq!([nice(0.07), nice(1.0), nice(4.9), nice(31.0)].map(times), ["1/20", "×1", "×2", "×20"]);
    }

    /// A fast motor is slowed down, a part that hardly moves is enlarged.
    #[test]
    fn the_scale_follows_the_motion() {
        let motion = |fastest: f64, farthest: f64| Motion {
            span_s: [0.0, 1.0],
            nodes: Vec::new(),
            springs: Vec::new(),
            misfits: Vec::new(),
            fastest,
            farthest,
            rotates: true,
        };
        let player = Player::default();
        assert_eq!(player.angle_scale(&motion(300.0, 300.0)), 0.01);
        assert_eq!(player.angle_scale(&motion(0.1, 0.02)), 20.0);
        assert_eq!(Player { speed: 0.01, ..player.clone() }.angle_scale(&motion(300.0, 300.0)), 1.0);
        assert_eq!(Player { scale: 0.1, ..player }.angle_scale(&motion(300.0, 300.0)), 0.1);
    }
}
