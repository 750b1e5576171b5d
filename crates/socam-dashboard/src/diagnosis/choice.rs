//! The residuals of a diagnosis that are drawn, and their horizontal axis.

use egui::Ui;
use socam_model::Motion;
use socam_workbench::display_units::DisplayUnits;

/// Draws the choices.
pub(super) fn ui(ui: &mut Ui, over: &mut Over, sides: &mut Sides) {
    ui.horizontal_wrapped(|ui| {
        for own in Over::ALL {
            ui.selectable_value(over, own, own.name());
        }
        // The switch is not broken over two lines.
        let names = [(Sides::Before, "before"), (Sides::After, "after"), (Sides::Both, "both")];
        let margin = ui.max_rect().left();
        ui.allocate_ui(egui::vec2(SWITCH, crate::together::row_height(ui)), |ui| {
            ui.horizontal(|ui| {
                // At the beginning of a line it has nothing to be separated from.
                if ui.max_rect().left() > margin + 1.0 {
                    ui.separator();
                }
                for (own, name) in names {
                    ui.selectable_value(sides, own, name);
                }
            });
        });
    });
}

/// Width of the switch between before, after and both, points.
const SWITCH: f32 = 190.0;

/// Residuals that are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sides {
    /// Residuals of the model without the findings.
    Before,
    /// Residuals of the model with the findings added.
    After,
    /// Both.
    #[default]
    Both,
}

/// The horizontal axis of the residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(missing_docs, reason = "each is named by its tab")]
pub enum Over {
    Signals,
    Shape,
    #[default]
    Speed,
    Angle,
    Torque,
    Frequency,
    Time,
    Fit,
}

impl Over {
    pub(super) const ALL: [Self; 8] = [
        Self::Signals,
        Self::Speed,
        Self::Angle,
        Self::Torque,
        Self::Frequency,
        Self::Time,
        Self::Shape,
        Self::Fit,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Signals => "measured and predicted",
            Self::Shape => "measured shape",
            Self::Speed => "over speed",
            Self::Angle => "over angle",
            Self::Torque => "over torque",
            Self::Frequency => "over frequency",
            Self::Time => "over time",
            Self::Fit => "fit",
        }
    }
}

/// The choice, with the selected channel and recording, and the units in which signals are shown.
pub(super) struct Choice<'a> {
    pub(super) units: &'a DisplayUnits,
    /// How the machine moves, which names the axes.
    pub(super) motion: Motion,
    pub(super) sides: Sides,
    pub(super) over: Over,
    pub(super) channel: &'a mut usize,
    pub(super) recording: &'a mut usize,
}
