//! Contrast of text, lines and controls, and colours that people with any kind of colour vision can tell apart.

use super::*;

/// Red, green and blue, linear, 0 to 1.
type Linear = [f64; 3];

fn linear(colour: Color32) -> Linear {
    [colour.r(), colour.g(), colour.b()].map(|value| {
        let value = f64::from(value) / 255.0;
        if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    })
}

fn times(matrix: &[[f64; 3]; 3], own: Linear) -> Linear {
    matrix.map(|row| row.iter().zip(own).map(|(a, b)| a * b).sum())
}

/// Contrast of two colours by WCAG 2, 1 to 21.
fn contrast(a: Color32, b: Color32) -> f64 {
    let luminance = |colour| {
        let [r, g, b] = linear(colour);
        0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
    };
    let (a, b): (f64, f64) = (luminance(a), luminance(b));
    a.max(b) / a.min(b)
}

/// How colours appear by G. M. Machado, M. M. Oliveira and L. A. F. Fernandes (2009), at full severity; the least distance that is asked for.
const SIGHTS: [(&str, [[f64; 3]; 3], f64); 4] = [
    ("normal sight", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 12.0),
    (
        "protanopia",
        [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ],
        8.0,
    ),
    (
        "deuteranopia",
        [
            [0.367_322, 0.860_646, -0.227_968],
            [0.280_085, 0.672_501, 0.047_413],
            [-0.011_820, 0.042_940, 0.968_881],
        ],
        8.0,
    ),
    (
        "tritanopia",
        [
            [1.255_528, -0.076_749, -0.178_779],
            [-0.078_411, 0.930_809, 0.147_602],
            [0.004_733, 0.691_367, 0.303_900],
        ],
        6.5,
    ),
];

/// Distance of two colours in OKLab, B. Ottosson (2020), in per cent of the distance from black to white.
fn distance(a: Linear, b: Linear) -> f64 {
    let lab = |own: Linear| {
        let cones = times(
            &[
                [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
                [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
                [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
            ],
            own.map(|value| value.clamp(0.0, 1.0)),
        );
        times(
            &[
                [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
                [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
                [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
            ],
            cones.map(f64::cbrt),
        )
    };
    100.0 * lab(a).iter().zip(lab(b)).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Something in the colours of a look.
fn with<T>(look: Look, of: impl Fn(&Ui) -> T) -> T {
    let ctx = egui::Context::default();
    apply(&ctx, look);
    let mut found = None;
    let mut drawn = ctx.run_ui(egui::RawInput::default(), |ui| found = Some(of(ui)));
    drawn.textures_delta.clear();
    found.unwrap()
}

const LOOKS: [Look; 2] = [Look::Light, Look::Dark];

#[test]
fn lines_differ_for_every_kind_of_sight() {
    for look in LOOKS {
        let colours: Vec<Linear> = with(look, |ui| (0..8).map(|number| linear(line(ui, number))).collect());
        for (sight, matrix, least) in SIGHTS {
            for (first, second) in (0..8).flat_map(|first| (0..first).map(move |second| (first, second))) {
                let apart = distance(times(&matrix, colours[first]), times(&matrix, colours[second]));
                assert!(apart >= least, "{look:?}, {sight}: lines {second} and {first} differ by {apart:.1}");
            }
        }
        // What was and what is now, wherever both are drawn.
        let pair = with(look, |ui| [linear(alarm(ui)), linear(good(ui))]);
        for (sight, matrix, least) in SIGHTS {
            let apart = distance(times(&matrix, pair[0]), times(&matrix, pair[1]));
            assert!(apart >= 1.5 * least, "{look:?}, {sight}: alarm and good differ by {apart:.1}");
        }
    }
}

#[test]
fn lines_controls_and_text_stand_out_from_their_ground() {
    for look in LOOKS {
        with(look, |ui| {
            let visuals = ui.visuals();
            let grounds = [visuals.panel_fill, visuals.window_fill, visuals.extreme_bg_color];
            let stands_out = |what: &str, colour: Color32, grounds: &[Color32], least: f64| {
                for ground in grounds {
                    let own = contrast(colour, *ground);
                    assert!(
                        own >= least,
                        "{look:?}: {what} on {ground:?} has {own:.2}:1, less than {least}:1"
                    );
                }
            };
            (0..8).for_each(|number| stands_out(&format!("line {number}"), line(ui, number), &grounds, 3.0));
            for (what, widget) in [("control", visuals.widgets.inactive), ("focus", visuals.widgets.active)] {
                assert!(widget.bg_stroke.width >= 1.0, "{look:?}: {what} has no outline");
                stands_out(what, widget.bg_stroke.color, &grounds, 3.0);
                stands_out(what, widget.fg_stroke.color, &[widget.bg_fill, widget.weak_bg_fill], 4.5);
            }
            for (what, colour) in
                [("text", body(ui)), ("weak text", weak(ui)), ("alarm", alarm(ui)), ("good", good(ui))]
            {
                stands_out(what, colour, &grounds, 4.5);
                stands_out(what, colour, &[visuals.faint_bg_color], 4.5);
            }
            stands_out("alarm", alarm(ui), &[alarm_ground(ui)], 4.5);
            stands_out("stop", Color32::WHITE, &[STOP], 4.5);
            stands_out("selection", visuals.selection.stroke.color, &[visuals.selection.bg_fill], 4.5);
        });
    }
}
