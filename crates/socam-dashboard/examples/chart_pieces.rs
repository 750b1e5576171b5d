//! Draws the pieces that charts are made of, light and dark, to be looked at:
//! `cargo run --release -p socam-dashboard --example chart_pieces -- FOLDER`.

use std::f64::consts::TAU;
use std::path::PathBuf;

use egui::{Color32, Event, RawInput, Rect, Theme, Ui, pos2, vec2};
use socam_chart::chart::{Backdrop, Chart, Curve, Flag, Seen, Style, opacity};
use socam_chart::colours::Colours;
use socam_chart::heat::Heat;
use socam_chart::raster::{Raster, png};
use socam_chart::xy::{Cloud, Thinner};
use socam_chart::{svg, theme};
use socam_dashboard::spectra::spectrogram::{colours, spectrogram};
use socam_recording::{Channel, Dataset, Unit};
use socam_samples::{Samples, envelope};
use socam_workbench::job::Handle;

const SIZE: [f32; 2] = [1280.0, 1200.0];

/// A multisine, its low-passed answer, and a chirp; with a gap.
fn samples() -> Samples {
    let time_s: Vec<f64> =
        (0..20_000).filter(|n| !(9000..9800).contains(n)).map(|n| f64::from(n) * 1e-3).collect();
    let sum = |t: f64, slow: f64| -> f64 {
        let line = |n: i32| {
            let hz = 0.7 + 3.7 * f64::from(n);
            (TAU * hz * t + f64::from(n * n) * 1.7 - (hz * slow).atan()).sin() / (1.0 + hz * slow)
        };
        0.25 * (0..40).map(line).sum::<f64>()
    };
    let columns: Vec<Vec<f64>> = vec![
        time_s.iter().map(|t| sum(*t, 0.0)).collect(),
        time_s.iter().map(|t| 4.0 * sum(*t, 0.5)).collect(),
        time_s
            .iter()
            .map(|t| (TAU * (10.0 * t + 10.0 * t * t)).sin() + 0.2 * (TAU * 180.0 * t).sin())
            .collect(),
    ];
    let channels = ["torque_in", "torque_out", "chirp"].map(|name| Channel::new(name, Unit::Nm));
    let data = Dataset::from_columns("r", channels.into(), time_s.clone(), columns.clone());
    let segments = data.map(|data| data.segments().to_vec()).unwrap_or_default();
    Samples::in_memory(time_s, &columns, segments)
}

fn curve(samples: &Samples, channel: usize, colour: Color32, x: [f64; 2]) -> Curve {
    let parts = envelope(samples, channel, x[0], x[1], 1200).parts;
    Curve { name: format!("runs/multisine-{channel}.mcap"), colour, parts, style: Style::Solid }
}

fn over_time(ui: &mut Ui, samples: &Samples, seen: &mut Vec<Seen>) {
    for (number, (title, x)) in
        [("torque_in, N m", [0.0, 20.0]), ("torque_in at 1 s, N m", [0.98, 1.3])].into_iter().enumerate()
    {
        let mut chart = Chart::new(("time", number), title, vec2(1280.0, 200.0));
        chart.x = x;
        chart.x_label = "time, s".into();
        chart.curves = (0..2).map(|channel| curve(samples, channel, theme::line(ui, channel), x)).collect();
        chart.y = chart.fitted(Some([-3.2, 3.2]));
        chart.shaded = vec![([8.999, 9.8], theme::line(ui, 0).gamma_multiply(0.16))];
        chart.flags = vec![Flag::new(12.5, "fault: too fast", theme::alarm(ui))];
        chart.lit = (number == 1).then_some(1);
        chart.hover = (number == 1).then_some(1.1);
        chart.show(ui, seen);
    }
    let mut many = Chart::new("many", "twenty-four runs, N m", vec2(1280.0, 160.0));
    many.x = [0.0, 6.0];
    many.opacity = opacity(24);
    for number in 0..24 {
        let mut own = curve(samples, 1, theme::line(ui, number), [0.0, 6.0]);
        own.parts.iter_mut().flatten().for_each(|point| point[1] *= 1.0 + 0.02 * number as f64);
        many.curves.push(own);
    }
    many.y = many.fitted(Some([-5.0, 5.0]));
    many.show(ui, seen);
}

fn over_each_other(ui: &mut Ui, samples: &Samples, seen: &mut Vec<Seen>) {
    let rows = 0..samples.rows();
    let ranges = [0, 1].map(|channel| samples.extremes(channel, rows.clone()).unwrap_or([0.0, 1.0]));
    let mut thinner = Thinner::new(ranges, [600, 160]);
    let (x, y) = (samples.values(0, rows.clone()), samples.values(1, rows.clone()));
    let times = samples.times(rows);
    x.iter().zip(&y).zip(&times).for_each(|((x, y), t)| thinner.push([*x, *y, *t]));
    let mut chart = Chart::new("xy", "torque_out, N m", vec2(1280.0, 330.0));
    chart.x_label = "torque_in, N m".into();
    chart.x = socam_chart::chart::with_room(ranges[0]);
    chart.y = chart.fitted(Some(ranges[1]));
    let colours = Colours::of_dots(ui, [0.0, 20.0], "time, s");
    chart.backdrop = Some(Backdrop::Cloud(Cloud { dots: thinner.dots(), colours }));
    chart.show(ui, seen);
}

fn field(ui: &mut Ui, heat: Option<&Heat>, seen: &mut Vec<Seen>) {
    let mut chart = Chart::new("field", "frequency, Hz", vec2(1280.0, 270.0));
    chart.x_label = "time, s".into();
    (chart.x, chart.y) = ([0.0, 20.0], [0.0, 500.0]);
    chart.backdrop = heat.cloned().map(Backdrop::Heat);
    chart.show(ui, seen);
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("say into which folder")?);
    std::fs::create_dir_all(&folder)?;
    let samples = samples();
    let cells =
        spectrogram(&samples, 2, [0.0, 20.0], (400, socam_spectrum::Welch::new(256)), &Handle::default())?;
    for (look, name) in [(theme::Look::Light, "light"), (theme::Look::Dark, "dark")] {
        let ctx = egui::Context::default();
        theme::apply(&ctx, look);
        ctx.set_theme(Theme::from(look));
        let mut raster = Raster::default();
        let range = colours(&cells);
        let density = Colours::of_fields(range, "power density, dB ((N m)²/Hz)");
        let heat = Heat::new(&ctx, "field", cells.clone(), density);
        let mut seen = Vec::new();
        for pass in 0..4 {
            let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(SIZE[0], SIZE[1]));
            // The pointer is in the first chart.
            let events = vec![Event::PointerMoved(pos2(700.0, 80.0))];
            let input = RawInput { screen_rect: Some(rect), events, ..RawInput::default() };
            seen.clear();
            let mut output = ctx.run_ui(input, |ui| {
                ui.spacing_mut().item_spacing.y = 4.0;
                over_time(ui, &samples, &mut seen);
                over_each_other(ui, &samples, &mut seen);
                field(ui, heat.as_ref(), &mut seen);
            });
            raster.take(&mut output.textures_delta);
            if pass == 3 {
                let ground = ctx.global_style().visuals.panel_fill;
                let image = raster.draw(&ctx, output.shapes, 1.0, SIZE.map(|side| side as usize), ground);
                std::fs::write(folder.join(format!("pieces-{name}.png")), png(&image)?)?;
            }
        }
        let text = svg::svg(&seen, look == theme::Look::Dark)?;
        std::fs::write(folder.join(format!("pieces-{name}.svg")), text)?;
    }
    Ok(())
}
