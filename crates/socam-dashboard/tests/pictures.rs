//! Every view is drawn and compared with its picture in `tests/snapshots`; `UPDATE_SNAPSHOTS=1` draws them anew.
//!
//! Drawn by the dashboard's own rasteriser, so they are the same on a machine without display or graphics card.

mod sample;

use std::time::Duration;

use egui_kittest::{SnapshotOptions, try_image_snapshot_options};
use socam_dashboard::diagnosis::Over;
use socam_dashboard::document::parse;
use socam_dashboard::spectra::Kind;
use socam_dashboard::theme::Look;
use socam_dashboard::{Dashboard, Layout, Sight, View, picture};

const SMALL: Sight = Sight { size: [1280.0, 800.0], scale: 1.0 };
const LARGE: Sight = Sight { size: [2560.0, 1440.0], scale: 1.0 };

fn dashboard(look: Look, view: View) -> Dashboard {
    Dashboard::new(Layout { look, view, ..Layout::default() })
}

fn with_runs(look: Look, view: View, runs: u32) -> Dashboard {
    let mut dashboard = dashboard(look, view);
    (0..runs).for_each(|number| dashboard.add_recording(sample::run(number, 8000)));
    dashboard
}

fn diagnosed(look: Look, over: Over) -> Dashboard {
    let mut dashboard = dashboard(look, View::Diagnosis);
    dashboard.show(parse("diagnosis.json", sample::DIAGNOSIS).unwrap());
    dashboard.show_evidence(sample::evidence());
    dashboard.diagnosis.over = over;
    dashboard
}

/// All states in which the views were looked at.
fn states() -> Vec<(&'static str, Dashboard, Sight)> {
    let mut time = with_runs(Look::Dark, View::Time, 2);
    time.review.cursors = Some([2.5, 5.25]);
    let mut trouble = dashboard(Look::Light, View::Time);
    trouble.add_recording(sample::troubled(8000));
    let mut one = dashboard(Look::Light, View::Time);
    one.add_recording(sample::of("one.csv", vec![2.0], vec![vec![1.0], vec![f64::NAN]]));
    let mut differences = with_runs(Look::Light, View::Time, 3);
    differences.review.reference = Some(0);
    let mut response = with_runs(Look::Dark, View::Frequency, 2);
    response.spectra.kind = Kind::Response;
    let mut poles = dashboard(Look::Light, View::Frequency);
    poles.spectra.kind = Kind::Poles;
    let mut parameters = dashboard(Look::Light, View::Parameters);
    parameters.show(parse("fit.json", sample::IDENTIFICATION).unwrap());
    let mut wrong = with_runs(Look::Dark, View::Time, 1);
    wrong.warn("runs/broken.mcap: this is no recording: byte 0 is not that of an MCAP log, a CSV table or a legacy log; expected one of these");
    vec![
        ("time", time, SMALL),
        ("time-trouble", trouble, SMALL),
        ("time-one-sample", one, SMALL),
        ("time-differences", differences, LARGE),
        ("time-twelve", with_runs(Look::Dark, View::Time, 12), SMALL),
        ("time-empty", dashboard(Look::Light, View::Time), SMALL),
        ("time-wrong", wrong, SMALL),
        ("spectrum", with_runs(Look::Light, View::Frequency, 2), SMALL),
        ("response", response, SMALL),
        ("poles", poles, SMALL),
        ("parameters", parameters, SMALL),
        ("diagnosis", diagnosed(Look::Light, Over::Speed), SMALL),
        ("diagnosis-torque", diagnosed(Look::Dark, Over::Torque), LARGE),
        ("diagnosis-frequency", diagnosed(Look::Dark, Over::Frequency), SMALL),
        ("diagnosis-time", diagnosed(Look::Dark, Over::Time), SMALL),
        ("diagnosis-fit", diagnosed(Look::Light, Over::Fit), SMALL),
        ("diagnosis-shape", diagnosed(Look::Dark, Over::Shape), SMALL),
        ("live-empty", dashboard(Look::Dark, View::Live), SMALL),
    ]
}

#[test]
fn every_view_looks_as_it_did() {
    // Letters may come out a shade different where another processor rounds otherwise.
    let options = SnapshotOptions::new().threshold(1.0).max_failed_pixels(40);
    let mut problems = Vec::new();
    for (name, mut dashboard, sight) in states() {
        let image = picture(&mut dashboard, sight, Duration::from_secs(60)).unwrap();
        let bytes: Vec<u8> = image.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
        let image = image::RgbaImage::from_raw(image.size[0] as u32, image.size[1] as u32, bytes).unwrap();
        if let Err(problem) = try_image_snapshot_options(&image, name, &options) {
            problems.push(problem.to_string());
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn the_same_state_gives_the_same_bytes() {
    let draw = || {
        let mut dashboard = with_runs(Look::Dark, View::Time, 2);
        picture(&mut dashboard, SMALL, Duration::from_secs(60)).unwrap().pixels
    };
    assert!(draw() == draw());
}
