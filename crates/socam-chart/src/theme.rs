//! Colours, fonts and spacing, light and dark.
//!
//! Any two of the eight colours of lines differ for people with normal sight, protanopia, deuteranopia and tritanopia, and all have a
//! contrast of 3:1 or more to their ground, as the outlines of controls have; text has 4.5:1. The tests of this file hold it.

use crate::style::{MarkerShape, Style};
use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, Theme, Ui, Visuals, vec2};

/// Light or dark appearance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Look {
    /// Dark text on a light background.
    Light,
    /// Light text on a dark background.
    Dark,
}

impl From<Theme> for Look {
    fn from(theme: Theme) -> Self {
        match theme {
            Theme::Light => Self::Light,
            Theme::Dark => Self::Dark,
        }
    }
}

impl From<Look> for Theme {
    fn from(look: Look) -> Self {
        match look {
            Look::Light => Self::Light,
            Look::Dark => Self::Dark,
        }
    }
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

const LINES_LIGHT: [Color32; 8] = [
    rgb(0x0c5bd5),
    rgb(0xde6b00),
    rgb(0x558a6a),
    rgb(0xc272a4),
    rgb(0x0b91e9),
    rgb(0x8f4e03),
    rgb(0x4d4c56),
    rgb(0xaa0f8c),
];
const LINES_DARK: [Color32; 8] = [
    rgb(0x18acf1),
    rgb(0xe58a4a),
    rgb(0x3bd791),
    rgb(0xc28cb2),
    rgb(0x4077e6),
    rgb(0xf3c107),
    rgb(0xc7cbd5),
    rgb(0x777a81),
];

/// The colour of the line of this number. Colours repeat after eight lines, with markers on the lines: see [`marker`].
#[must_use]
pub fn line(ui: &Ui, number: usize) -> Color32 {
    let colours = if ui.visuals().dark_mode { &LINES_DARK } else { &LINES_LIGHT };
    colours[number % colours.len()]
}

/// A colour of the window, which is dark or light, as it is on white paper: red, green and blue in hexadecimal, and its opacity. Lines
/// have the colours of the light appearance, and text that is light is dark.
#[must_use]
pub fn on_paper(colour: Color32, is_dark: bool) -> (String, f32) {
    let [r, g, b, a] = colour.to_srgba_unmultiplied();
    // Rounding of translucent colours changes a shade by up to this much.
    let slack = if a == 0 { 255 } else { (255 / u16::from(a) + 1).min(40) };
    let is = |other: &Color32| {
        let pairs = [r, g, b].into_iter().zip([other.r(), other.g(), other.b()]);
        pairs.into_iter().all(|(own, other)| u16::from(own.abs_diff(other)) <= slack)
    };
    let on_dark = LINES_DARK.iter().position(is).filter(|_| is_dark);
    let [r, g, b] = match on_dark {
        Some(number) => [LINES_LIGHT[number].r(), LINES_LIGHT[number].g(), LINES_LIGHT[number].b()],
        None if is_dark && r.min(g).min(b) > 150 => [255 - r, 255 - g, 255 - b],
        None => [r, g, b],
    };
    (format!("{r:02x}{g:02x}{b:02x}"), f32::from(a) / 255.0)
}

/// The marker that distinguishes the line of this number from another one of its colour.
#[must_use]
pub fn marker(number: usize) -> Option<MarkerShape> {
    const SHAPES: [MarkerShape; 5] =
        [MarkerShape::Diamond, MarkerShape::Square, MarkerShape::Up, MarkerShape::Down, MarkerShape::Circle];
    let round = number / LINES_LIGHT.len();
    round.checked_sub(1).map(|round| SHAPES[round % SHAPES.len()])
}

/// Style of the line with this number.
#[must_use]
pub fn style(number: usize) -> Style {
    marker(number).map_or(Style::Solid, Style::Marked)
}

/// Colour of errors and of places of findings.
#[must_use]
pub fn alarm(ui: &Ui) -> Color32 {
    if ui.visuals().dark_mode { rgb(0xff8a4c) } else { rgb(0xb34700) }
}

/// Colour of success and of the corrected model.
#[must_use]
pub fn good(ui: &Ui) -> Color32 {
    if ui.visuals().dark_mode { rgb(0x56b4e9) } else { rgb(0x006aa6) }
}

/// Background of an alarm.
#[must_use]
pub fn alarm_ground(ui: &Ui) -> Color32 {
    if ui.visuals().dark_mode { rgb(0x3a2517) } else { rgb(0xfdeadd) }
}

/// Colour of the stop button.
pub const STOP: Color32 = rgb(0xc1121f);

/// Colour of text.
#[must_use]
pub fn body(ui: &Ui) -> Color32 {
    ui.visuals().text_color()
}

/// Colour of secondary text.
#[must_use]
pub fn weak(ui: &Ui) -> Color32 {
    if ui.visuals().dark_mode { rgb(0x9aa4ad) } else { rgb(0x5d6770) }
}

/// Colour of the lines of grids.
#[must_use]
pub fn grid(ui: &Ui) -> Color32 {
    if ui.visuals().dark_mode { rgb(0x3a434c) } else { rgb(0xc3ccd3) }
}

/// Background of cards.
#[must_use]
pub fn card(ui: &Ui) -> Color32 {
    if ui.visuals().dark_mode { rgb(0x1d2227) } else { rgb(0xffffff) }
}

/// Sets fonts, colours and spacing.
pub fn apply(ctx: &egui::Context, look: Look) {
    ctx.set_theme(Theme::from(look));
    ctx.set_visuals_of(Theme::Light, light());
    ctx.set_visuals_of(Theme::Dark, dark());
    ctx.all_styles_mut(|style| {
        style.animation_time = 0.0;
        style.spacing.item_spacing = vec2(8.0, 6.0);
        style.spacing.button_padding = vec2(9.0, 4.0);
        style.spacing.menu_margin = Margin::same(6);
        style.spacing.scroll.floating = false;
        style.spacing.scroll.bar_width = 7.0;
        style.spacing.scroll.foreground_color = false;
        style.text_styles = [
            (TextStyle::Heading, FontId::new(18.0, FontFamily::Proportional)),
            (TextStyle::Body, FontId::new(13.5, FontFamily::Proportional)),
            (TextStyle::Button, FontId::new(13.5, FontFamily::Proportional)),
            (TextStyle::Small, FontId::new(11.5, FontFamily::Proportional)),
            (TextStyle::Monospace, FontId::new(12.5, FontFamily::Monospace)),
        ]
        .into();
    });
}

fn light() -> Visuals {
    let mut visuals = Visuals::light();
    visuals.panel_fill = rgb(0xf3f5f7);
    visuals.window_fill = rgb(0xffffff);
    visuals.extreme_bg_color = rgb(0xffffff);
    visuals.faint_bg_color = rgb(0xe9edf0);
    // Visible on white cards.
    visuals.text_edit_bg_color = Some(rgb(0xeaeef1));
    visuals.selection.bg_fill = rgb(0xcfe5f5);
    visuals.selection.stroke = Stroke::new(1.0, rgb(0x00466f));
    visuals.hyperlink_color = rgb(0x0067a3);
    text(&mut visuals, rgb(0x1f262c), rgb(0x000000));
    ground(
        &mut visuals,
        [rgb(0xe3e8ec), rgb(0xd5dde3), rgb(0xc2cdd6)],
        [rgb(0xcdd5db), rgb(0x6f7b86), rgb(0x006aa6)],
    );
    visuals
}

fn dark() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.panel_fill = rgb(0x15191d);
    visuals.window_fill = rgb(0x1d2227);
    visuals.extreme_bg_color = rgb(0x0e1114);
    visuals.faint_bg_color = rgb(0x1b2025);
    visuals.selection.bg_fill = rgb(0x1d4a68);
    visuals.selection.stroke = Stroke::new(1.0, rgb(0xd5ecff));
    visuals.hyperlink_color = rgb(0x74c0f5);
    text(&mut visuals, rgb(0xdde3e8), rgb(0xffffff));
    ground(
        &mut visuals,
        [rgb(0x2a3138), rgb(0x36404a), rgb(0x455260)],
        [rgb(0x333b43), rgb(0x7d8a96), rgb(0x56b4e9)],
    );
    visuals
}

fn text(visuals: &mut Visuals, body: Color32, strong: Color32) {
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.fg_stroke.color = body;
    widgets.inactive.fg_stroke.color = body;
    widgets.hovered.fg_stroke.color = strong;
    widgets.active.fg_stroke.color = strong;
    widgets.open.fg_stroke.color = strong;
}

/// Fills of controls, the lines between parts of the window, outlines of controls, and the ring around the control that has the keyboard.
fn ground(
    visuals: &mut Visuals,
    [inactive, hovered, active]: [Color32; 3],
    [line, outline, focus]: [Color32; 3],
) {
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, line);
    for (widget, fill) in [
        (&mut widgets.inactive, inactive),
        (&mut widgets.hovered, hovered),
        (&mut widgets.active, active),
        (&mut widgets.open, hovered),
    ] {
        widget.weak_bg_fill = fill;
        widget.bg_fill = fill;
        widget.bg_stroke = Stroke::new(1.0, outline);
        widget.expansion = 0.0;
        widget.corner_radius = CornerRadius::same(4);
    }
    // A control that has the keyboard is drawn as an active one.
    widgets.active.bg_stroke = Stroke::new(2.0, focus);
    visuals.window_stroke = Stroke::new(1.0, line);
    visuals.slider_trailing_fill = true;
}

#[cfg(test)]
mod tests;
