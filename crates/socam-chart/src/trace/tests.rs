use std::f64::consts::TAU;

use egui::{Color32, ColorImage, RawInput, Rect, pos2, vec2};
use socam_recording::{Channel, Dataset, Unit};

use super::*;
use crate::chart::{Chart, Curve, Shown, Style};
use crate::raster::Raster;
use socam_samples::{Samples, envelope};

/// A multisine of 10 s at 1 kHz: 40 lines up to 150 Hz with phases that do not line up.
fn multisine() -> Samples {
    let time_s: Vec<f64> = (0..10_000).map(|row| f64::from(row) * 1e-3).collect();
    let line = |n: i32, t: f64| (TAU * (0.7 + 3.7 * f64::from(n)) * t + f64::from(n * n) * 1.7).sin();
    let values: Vec<f64> = time_s.iter().map(|t| 0.25 * (0..40).map(|n| line(n, *t)).sum::<f64>()).collect();
    let channels = vec![Channel::new("torque_in", Unit::Nm)];
    let data = Dataset::from_columns("r", channels, time_s.clone(), vec![values.clone()]).unwrap();
    Samples::in_memory(time_s, &[values], data.segments().to_vec())
}

fn is_red(pixel: &Color32) -> bool {
    i32::from(pixel.r()) - i32::from(pixel.g()) > 24
}

/// A chart of one red line.
fn drawn(parts: Vec<Vec<[f64; 2]>>, y: [f64; 2], width: f32, scale: f32) -> (ColorImage, Shown) {
    let ctx = egui::Context::default();
    ctx.set_theme(egui::Theme::Dark);
    let mut raster = Raster::default();
    let size = vec2(width, 300.0);
    let mut last = None;
    for _ in 0..3 {
        let mut input =
            RawInput { screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), size)), ..RawInput::default() };
        input.viewports.entry(input.viewport_id).or_default().native_pixels_per_point = Some(scale);
        let mut shown = None;
        let mut output = ctx.run_ui(input, |ui| {
            let mut chart = Chart::new("c", "", size);
            (chart.x, chart.y) = ([0.0, 10.0], y);
            chart.curves = vec![Curve {
                name: "c".into(),
                colour: Color32::RED,
                parts: parts.clone(),
                style: Style::Solid,
            }];
            shown = Some(chart.show(ui, &mut Vec::new()));
        });
        raster.take(&mut output.textures_delta);
        let pixels = [width, 300.0].map(|side| (side * scale) as usize);
        let image = raster.draw(&ctx, output.shapes, output.pixels_per_point, pixels, Color32::BLACK);
        last = Some((image, shown.unwrap()));
    }
    last.unwrap()
}

/// First and last row of pixels with the line.
fn rows(image: &ColorImage) -> [f32; 2] {
    let rows = image.pixels.chunks(image.size[0]).enumerate().filter(|(_, row)| row.iter().any(is_red));
    let rows: Vec<usize> = rows.map(|(row, _)| row).collect();
    [*rows.first().unwrap() as f32, (*rows.last().unwrap() + 1) as f32]
}

#[test]
fn no_pixel_of_a_line_is_outside_of_the_range_of_its_values() {
    let samples = multisine();
    let [low, high] = samples.extremes(0, 0..10_000).unwrap();
    for (width, scale) in [(400.0, 1.0), (800.0, 1.5), (1600.0, 1.0), (2560.0, 2.0)] {
        let line = envelope(&samples, 0, 0.0, 10.0, width as usize);
        let (image, shown) = drawn(line.parts, [-3.0, 3.0], width, scale);
        let row = |value: f64| {
            scale * shown.frame.bottom()
                - scale * shown.frame.height() * ((value - shown.y[0]) / (shown.y[1] - shown.y[0])) as f32
        };
        let [first, last] = rows(&image);
        // Half of the line's width, and a pixel in which it fades.
        let room = 0.5 * WIDTH * scale + 1.0;
        assert!(
            first >= row(high) - room && last <= row(low) + room,
            "{width}: {first}..{last}, values end at {} and {}",
            row(high),
            row(low)
        );
        assert!(first <= row(high) && last >= row(low), "{width}: the picture hides a peak");
    }
}

#[test]
fn a_spike_of_one_sample_is_as_high_as_its_value_however_dense_the_line() {
    for count in [300, 3000, 30_000] {
        let spike = count / 2;
        let point = |n: usize| {
            [10.0 * n as f64 / count as f64, if n == spike { 2.0 } else { 0.1 * (n as f64).sin() }]
        };
        let (image, shown) = drawn(vec![(0..count).map(point).collect()], [-3.0, 3.0], 800.0, 1.0);
        let top = shown.frame.bottom() - shown.frame.height() * 5.0 / 6.0;
        let first = rows(&image)[0];
        assert!((top - 2.0..top + 1.5).contains(&first), "{count}: drawn to {first}, is at {top}");
        // Below its tip the spike is opaque.
        let row = &image.pixels[(top as usize + 12) * image.size[0]..][..image.size[0]];
        assert!(row.iter().any(|pixel| pixel.r() > 200), "{count}");
    }
}

#[test]
fn dense_and_sparse_stretches_of_a_line_join() {
    let dense = (0..4000).map(|n| [f64::from(n) * 0.1, f64::from(n % 2) * 20.0 + 100.0]);
    let sparse = (0..40).map(|n| [400.0 + 10.0 * f64::from(n), 100.0 + f64::from(n)]);
    let points: Vec<[f64; 2]> = dense.chain(sparse).collect();
    let stretches = stretches(&points);
    assert_eq!(stretches.iter().map(|(_, dense)| *dense).collect::<Vec<_>>(), [true, false]);
    assert_eq!(stretches[0].0.last(), stretches[1].0.first());
    assert_eq!(stretches.iter().map(|(points, _)| points.len()).sum::<usize>(), points.len() + 1);
}

#[test]
fn what_is_far_outside_is_cut_off_where_it_leaves_the_picture() {
    let clip = Rect::from_min_size(pos2(0.0, 0.0), vec2(100.0, 100.0));
    let runs = inside(&[[0.0, 50.0], [50.0, 50.0], [51.0, 1e12], [52.0, 50.0], [100.0, 50.0]], clip);
    assert_eq!(runs.len(), 2, "{runs:?}");
    assert!(runs.iter().flatten().all(|point| point.y <= 133.0), "{runs:?}");
    assert_eq!((runs[0][0], runs[1].last().copied()), (pos2(0.0, 50.0), Some(pos2(100.0, 50.0))));
    assert!((runs[1][0].x - 52.0).abs() < 1e-3, "{runs:?}");
    assert!(inside(&[[0.0, 500.0], [50.0, 500.0]], clip).is_empty());
}
