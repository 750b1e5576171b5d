//! `--diagnose` in the window: progress, cancellation, a second start, and the findings.

use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use socam_dashboard::{Dashboard, View};

use crate::commands::simulate;

#[derive(clap::Parser)]
struct Simulation {
    #[command(flatten)]
    args: simulate::Args,
}

fn until(window: &mut Harness<'_, Dashboard>, what: &str, is: impl Fn(&Harness<'_, Dashboard>) -> bool) {
    let begin = Instant::now();
    while !is(window) {
        assert!(begin.elapsed() < Duration::from_secs(300), "waited for {what}");
        std::thread::sleep(Duration::from_millis(5));
        window.run_steps(1);
    }
}

fn press(window: &mut Harness<'_, Dashboard>, label: &str) {
    let is_button = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() == egui::Role::Button;
    window.get_all_by_label(label).find(is_button).unwrap_or_else(|| panic!("no button {label}")).click();
    window.run_steps(2);
}

#[test]
fn a_diagnosis_in_the_window_says_how_far_it_is_is_cancelled_and_runs_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["multisine", "triangle", "reversals"];
    let paths = names.map(|name| folder.path().join(format!("{name}.mcap")).display().to_string());
    for (name, path) in names.iter().zip(&paths) {
        let hidden = "coulomb_friction@load_bearing:torque=0.4";
        let words = ["", "--profile", name, "--duration", "4s", "--hide", hidden, "-o", path];
        let simulation: Simulation = clap::Parser::parse_from(words);
        simulate::run(simulation.args).unwrap();
    }
    let mut dashboard = Dashboard::default();
    dashboard.open(paths.clone());
    dashboard.diagnose(vec![paths[2].clone()]);
    let harness = Harness::builder().with_size([1280.0, 800.0]);
    let mut window = harness.build_ui_state(|ui, dashboard: &mut Dashboard| dashboard.ui(ui), dashboard);
    let progress = |window: &Harness<'_, Dashboard>| {
        window.state().layout.view == View::Diagnosis && window.query_by_label("Cancel").is_some()
    };
    until(&mut window, "progress", progress);
    assert_eq!(window.state().layout.view, View::Diagnosis);
    press(&mut window, "Cancel");
    assert!(!window.state().is_busy());
    window.get_by_label("No diagnosis yet");

    // The recording that was held out is still held out.
    press(&mut window, "Diagnose");
    until(&mut window, "progress", progress);
    until(&mut window, "the end", |window| !window.state().is_busy());
    window.run_steps(2);
    assert_eq!(window.state().problems().collect::<Vec<_>>(), Vec::<&str>::new());
    window.get_by_label("1. Coulomb friction at load_bearing");
    window.get_by_label("load_bearing: bearing with damping; finding 1, Coulomb friction");
    window.get_by_label_contains("Confirmed on held-out recordings");
}
