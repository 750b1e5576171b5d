//! `--watch` in the window: a change that begins in mid-run raises an alarm with its time and causes.

use std::path::Path;
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use socam_dashboard::{Dashboard, View};

use crate::commands::simulate;

/// Time at which the friction begins, s.
const BEGINS_S: f64 = 14.0;

#[derive(clap::Parser)]
struct Simulation {
    #[command(flatten)]
    args: simulate::Args,
}

fn simulated(folder: &Path, name: &str, more: &[&str]) -> String {
    let path = folder.join(format!("{name}.mcap")).display().to_string();
    let words = ["", "--profile", "multisine", "-o", &path];
    let simulation: Simulation = clap::Parser::parse_from(words.iter().chain(more));
    simulate::run(simulation.args).unwrap();
    path
}

fn until(window: &mut Harness<'_, Dashboard>, is: impl Fn(&Harness<'_, Dashboard>) -> bool) {
    let begin = Instant::now();
    while !is(window) {
        assert!(begin.elapsed() < Duration::from_secs(120), "the watch did not end");
        std::thread::sleep(Duration::from_millis(5));
        window.run_steps(1);
    }
}

#[test]
fn a_replay_raises_an_alarm_where_the_bench_changes() {
    let folder = tempfile::tempdir().unwrap();
    let friction = "coulomb_friction@load_bearing:torque=0.1";
    let changes = ["--duration", "24s", "--seed", "3", "--hide", friction, "--begin-at", "14s"];
    let changed = simulated(folder.path(), "changed", &changes);
    let healthy = simulated(folder.path(), "healthy", &["--duration", "40s"]);
    let mut dashboard = Dashboard::default();
    dashboard.open([changed, healthy]);
    dashboard.watch();
    let harness = Harness::builder().with_size([1280.0, 800.0]);
    let mut window = harness.build_ui_state(|ui, dashboard: &mut Dashboard| dashboard.ui(ui), dashboard);
    until(&mut window, |window| !window.state().is_busy());
    window.run_steps(2);
    assert_eq!(window.state().problems().collect::<Vec<_>>(), Vec::<&str>::new());
    assert_eq!(window.state().layout.view, View::Watch);
    let [alarm] = window.state().views.watch.alarms() else {
        panic!("{:?}", window.state().views.watch.alarms())
    };
    assert!((BEGINS_S - 0.6..BEGINS_S + 3.0).contains(&alarm.time_s), "{alarm:?}");
    window.get_by_label(&format!("Alarm 1 at {:.2} s", alarm.time_s));
    // The window has passed the alarm; its samples are still drawn.
    window.get_by_label("around alarm 1");
    window.get_by_label("Watch: 1 alarm");
    window.get_by_label("changed.mcap has changed");
    window.get_by_label_contains("Coulomb friction at");
    window.get_by_label("Chart output_speed, rad/s");
    window.get_by_label("Chart largest test, in units of its threshold");
}
