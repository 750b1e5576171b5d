//! The banner: what was found and how sure it is, in the words of the report and of the terminal.

use egui::{Frame, Label, Margin, RichText, Ui};
use socam_findings::Diagnosis;
use socam_findings::headline::{Tone, headline};

use socam_chart::numbers::plain;
use socam_chart::theme;

/// Draws the headline with all explanations that tie, the sizes, and how sure it is.
pub(super) fn banner(ui: &mut Ui, diagnosis: &Diagnosis) {
    let headline = headline(diagnosis);
    let (ground, colour) = match headline.tone {
        Tone::Adequate => (theme::card(ui), theme::good(ui)),
        Tone::Missing | Tone::Unexplained | Tone::Contradicted => (theme::alarm_ground(ui), theme::alarm(ui)),
    };
    Frame::new().fill(ground).corner_radius(6).inner_margin(Margin::symmetric(10, 6)).show(ui, |ui| {
        ui.add(Label::new(RichText::new(plain(&headline.title)).strong().size(17.0).color(colour)).wrap());
        for claim in &headline.claims {
            let Some(size) = &claim.size else { continue };
            let text =
                if headline.claims.len() > 1 { format!("{}: {size}", claim.what) } else { size.clone() };
            ui.add(Label::new(RichText::new(plain(&text)).strong()).wrap());
        }
        let certainty = headline.certainty.join(" ");
        ui.add(Label::new(RichText::new(plain(&certainty)).small().color(theme::weak(ui))).wrap());
        ui.allocate_space(egui::vec2(ui.available_width(), 0.0));
    });
}
