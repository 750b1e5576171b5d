//! Operations of users, by the names that a screen reader would read out.

use std::time::{Duration, Instant};

use crate::sample;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use socam_dashboard::{Dashboard, Layout, View};
use socam_workbench::document::{Document, parse};

pub(crate) fn window(dashboard: Dashboard) -> Harness<'static, Dashboard> {
    let harness =
        Harness::builder().with_size([1280.0, 800.0]).with_step_dt(0.02).with_context_setup(|ctx| {
            socam_chart::theme::apply(ctx, socam_chart::theme::Look::Dark);
        });
    let mut window = harness.build_ui_state(|ui, dashboard: &mut Dashboard| dashboard.ui(ui), dashboard);
    window.run_steps(3);
    window
}

pub(crate) fn with(view: View, runs: u32) -> Harness<'static, Dashboard> {
    let mut dashboard = Dashboard::default();
    (0..runs).for_each(|number| dashboard.add_recording(sample::run(number, 4000)));
    dashboard.layout.view = view;
    window(dashboard)
}

/// Passes until something is true; what it waits for runs on other threads.
pub(crate) fn until(
    window: &mut Harness<'static, Dashboard>,
    what: &str,
    is: impl Fn(&Harness<'static, Dashboard>) -> bool,
) {
    let begin = Instant::now();
    while !is(window) {
        assert!(begin.elapsed() < Duration::from_secs(30), "waited for {what}");
        std::thread::sleep(Duration::from_millis(5));
        window.run_steps(1);
    }
}

pub(crate) fn click(window: &mut Harness<'static, Dashboard>, label: &str) {
    let is_no_text = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() != egui::Role::Label;
    let found = window.get_all_by_label(label).find(is_no_text);
    found.unwrap_or_else(|| panic!("nothing to click is called {label}")).click();
    window.run_steps(3);
}

pub(crate) fn has(window: &Harness<'static, Dashboard>, label: &str) -> bool {
    window.query_by_label(label).is_some()
}

pub(crate) fn press(window: &mut Harness<'static, Dashboard>, key: egui::Key) {
    window.key_press(key);
    window.run_steps(3);
}

/// Presses a button, and returns the text that it copies.
pub(crate) fn copied(window: &mut Harness<'static, Dashboard>, label: &str) -> String {
    window.get_by_label(label).click();
    for _ in 0..4 {
        window.run_steps(1);
        for command in &window.output().platform_output.commands {
            if let egui::OutputCommand::CopyText(text) = command {
                return text.clone();
            }
        }
    }
    panic!("{label} copies nothing")
}

#[test]
fn an_empty_window_says_what_to_do() {
    let mut window = window(Dashboard::default());
    window.get_by_label("No recording is open");
    for (tab, title) in [
        ("Live", "No device is connected"),
        ("Frequency", "No recording is shown"),
        ("Check", "No recording is open"),
        ("Identify", "No identification yet"),
        ("Diagnosis", "No diagnosis yet"),
    ] {
        click(&mut window, tab);
        window.get_by_label(title);
    }
    window.get_by_label("EMERGENCY STOP");
}

#[test]
fn recordings_lie_over_each_other_and_differ() {
    let mut window = with(View::Time, 2);
    assert!(window.state().views.time.reference.is_none());
    window.get_by_label("Chart torque_out, N m");
    window.state_mut().views.time.reference = Some(0);
    window.run_steps(2);
    window.get_by_label("Chart torque_out minus multisine-0.mcap, N m");
    window.state_mut().views.time.reference = None;
    window.run_steps(2);
    click(&mut window, "torque_out, N m");
    assert!(window.query_by_label("Chart torque_out, N m").is_none());
    let names = ["multisine-0.mcap", "multisine-1.mcap"];
    names.iter().for_each(|name| click(&mut window, name));
    window.get_by_label("Every recording is hidden");
    names.iter().for_each(|name| click(&mut window, name));
    window.get_by_label("Chart torque_in, N m");
    click(&mut window, "Close multisine-0.mcap");
    assert!(window.query_by_label("multisine-0.mcap").is_none());
    window.get_by_label("multisine-1.mcap");
}

#[test]
fn cursors_are_set_by_clicks_and_measure_differences() {
    let mut window = with(View::Time, 1);
    click(&mut window, "Cursors A, B");
    window.get_by_label("Sort by at A");
    let chart = window.get_by_label("Chart motor_speed, rad/s").rect();
    for share in [0.3, 0.7] {
        let at = chart.left() + share * chart.width();
        let pos = egui::pos2(at, chart.center().y);
        window.hover_at(pos);
        for pressed in [true, false] {
            let event = egui::Event::PointerButton {
                pos,
                button: egui::PointerButton::Primary,
                pressed,
                modifiers: egui::Modifiers::NONE,
            };
            window.event(event);
        }
        window.run_steps(2);
    }
    let [a, b] = window.state().views.time.cursors.unwrap();
    assert!((a - 1.2).abs() < 0.05 && (b - 2.8).abs() < 0.05, "{a} {b}");
    click(&mut window, "Zoom to A..B");
    let span = window.state().views.time.span(&[]);
    assert!((span[0] - a).abs() < 1e-6 && (span[1] - b).abs() < 1e-6, "{span:?}");
    click(&mut window, "Fit all");
}

/// A turn of the wheel that zooms in.
const WHEEL: egui::Event = egui::Event::MouseWheel {
    unit: egui::MouseWheelUnit::Point,
    delta: egui::vec2(0.0, 200.0),
    modifiers: egui::Modifiers::NONE,
    phase: egui::TouchPhase::Move,
    source: egui::MouseWheelSource::Wheel,
};

#[test]
fn dragging_pans_and_the_wheel_zooms_all_charts_alike() {
    let mut window = with(View::Time, 1);
    let chart = window.get_by_label("Chart torque_in, N m").rect();
    window.hover_at(chart.center());
    window.run_steps(1);
    window.event(WHEEL);
    window.run_steps(20);
    let span = window.state().views.time.span(&[]);
    assert!(span[1] - span[0] < 3.0 && span[0] > 0.2 && span[1] < 3.8, "{span:?}");
    window.key_press(egui::Key::ArrowRight);
    window.run_steps(2);
    assert!(window.state().views.time.span(&[])[0] > span[0]);
}

#[test]
fn a_plot_with_a_time_axis_of_its_own_is_zoomed_alone() {
    let mut window = with(View::Time, 1);
    let [own, other] =
        ["Chart torque_in, N m", "Chart motor_speed, rad/s"].map(|name| window.get_by_label(name).rect());
    window.hover_at(own.center());
    window.run_steps(2);
    click(&mut window, "More about the plot torque_in");
    click(&mut window, "Time axis of its own");
    window.hover_at(own.center());
    window.run_steps(1);
    window.event(WHEEL);
    window.run_steps(20);
    assert_eq!(window.state().views.time.x, None);
    window.hover_at(other.center());
    window.run_steps(1);
    window.event(WHEEL);
    window.run_steps(20);
    assert!(window.state().views.time.x.is_some());
}

#[test]
fn a_finding_is_lit_explained_and_becomes_an_input_signal() {
    let mut dashboard = Dashboard::default();
    dashboard.show(parse("diagnosis.json", sample::DIAGNOSIS).unwrap());
    let mut window = window(dashboard);
    window.get_by_label("load_bearing: bearing with damping; finding 1, Coulomb friction").click();
    window.run_steps(2);
    // The rival has a weight of 1 %, too little for a mark.
    window.get_by_label("coupling_3: spring with damper");
    window.get_by_label("1. Coulomb friction at load_bearing");
    for tab in ["over frequency", "over time", "measured shape", "fit", "after", "before"] {
        click(&mut window, tab);
    }
    window.get_by_label("Make it the input signal").scroll_to_me();
    window.run_steps(40);
    click(&mut window, "Make it the input signal");
    assert_eq!(window.state().layout.view, View::Live);
    assert!(
        window.state().workspace.signal.text().contains("triangle")
            || window.state().workspace.signal.settings.name().contains("profile")
    );
}

#[test]
fn what_is_not_determined_is_said() {
    let mut dashboard = Dashboard::default();
    let Ok(document @ Document::Identification(_)) = parse("fit.json", sample::IDENTIFICATION) else {
        panic!("no identification")
    };
    dashboard.show(document);
    let window = window(dashboard);
    window.get_by_label("its 95 % interval is ±368 %; it cannot be told apart from k2, c2, c3");
    window.get_by_label("133.35 to 135.29");
}

#[test]
fn spectra_and_poles_are_drawn() {
    let mut window = with(View::Frequency, 1);
    until(&mut window, "spectra", |window| !window.state().is_busy());
    window.get_by_label("Chart motor_speed, rad/s per sqrt(Hz)");
    click(&mut window, "Response");
    window.get_by_label("Chart coherence");
    click(&mut window, "Poles and zeros");
    window.get_by_label("damping ratio");
}

/// A picture of recordings with a report waited for work that only its own, hidden view would have noticed.
#[test]
fn work_of_a_hidden_view_ends() {
    let mut window = with(View::Frequency, 12);
    assert!(window.state().is_busy());
    window.state_mut().layout.view = View::Diagnosis;
    until(&mut window, "the spectra", |window| !window.state().is_busy());
}

#[test]
fn help_explains_each_control() {
    let mut window = with(View::Live, 0);
    click(&mut window, "Help");
    click(&mut window, "What each control does");
    window.get_by_label("EMERGENCY STOP; Esc");
}

#[test]
fn the_help_is_searched_and_runs_commands() {
    let mut window = with(View::Time, 1);
    window.key_press(egui::Key::F1);
    window.run_steps(3);
    window.get_by_label("EMERGENCY STOP; Esc");
    window.get_by_label("Search the help").type_text("show check");
    window.run_steps(3);
    assert!(window.query_by_label("EMERGENCY STOP; Esc").is_none());
    click(&mut window, "Run: Show Check");
    assert_eq!(window.state().layout.view, View::Check);
    assert!(window.query_by_label("Search the help").is_none());
}

/// Ctrl+S also fits where Ctrl+Shift+S is pressed.
#[test]
fn keys_with_shift_are_told_from_those_without() {
    let mut window = with(View::Time, 1);
    window.key_press_modifiers(egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, egui::Key::S);
    window.run_steps(3);
    window.get_by_label("Save the recording as (.csv or .m)");
    click(&mut window, "Cancel");
    window.key_press_modifiers(egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, egui::Key::W);
    window.run_steps(3);
    assert!(window.state().workspace.entries.is_empty());
}

#[test]
fn checks_are_sorted_and_unfold() {
    let mut window = with(View::Check, 3);
    window.state_mut().add_recording(sample::of("runs/a-short.csv", vec![0.0, 1e-3], vec![vec![1.0; 2]; 2]));
    // A check that has not begun yet is no work either.
    let is_checked =
        |window: &Harness<'static, Dashboard>| window.query_by_label("a-short.csv: findings").is_some();
    until(&mut window, "checks", |window| is_checked(window) && !window.state().is_busy());
    window.run_steps(3);
    let top = |window: &Harness<'static, Dashboard>, name: &str| window.get_by_label(name).rect().top();
    assert!(top(&window, "a-short.csv") > top(&window, "multisine-0.mcap"));
    click(&mut window, "Sort by rows");
    assert!(top(&window, "a-short.csv") < top(&window, "multisine-0.mcap"));
    click(&mut window, "Sort by rows");
    assert!(top(&window, "a-short.csv") > top(&window, "multisine-2.mcap"));
    assert!(window.query_all_by_label_contains("instead: ").next().is_none());
    click(&mut window, "a-short.csv: findings");
    assert!(window.query_all_by_label_contains("instead: ").next().is_some());
    click(&mut window, "a-short.csv: findings");
    assert!(window.query_all_by_label_contains("instead: ").next().is_none());
}

#[test]
fn the_menus_choose_a_signal_and_undo() {
    let mut window = with(View::Live, 0);
    let before = window.state().workspace.signal.settings.clone();
    click(&mut window, "Input Signal");
    click(&mut window, "constant");
    assert_ne!(window.state().workspace.signal.settings, before);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    window.run_steps(2);
    assert_eq!(window.state().workspace.signal.settings, before);
}

#[test]
fn panels_are_as_wide_as_they_were() {
    let layout = Layout { panels: [("recordings".into(), 333.0)].into(), ..Layout::default() };
    let mut dashboard = Dashboard::new(layout);
    dashboard.add_recording(sample::run(0, 100));
    let harness = Harness::builder().with_size([1280.0, 800.0]);
    let mut is_new = true;
    let mut window = harness.build_ui_state(
        move |ui, dashboard: &mut Dashboard| {
            if std::mem::take(&mut is_new) {
                dashboard.set_up(ui.ctx());
            }
            dashboard.ui(ui);
        },
        dashboard,
    );
    window.run_steps(4);
    assert_eq!(window.state().layout.panels["recordings"], 333.0);
}

/// The test covers all controls that can be pressed, dragged or typed into, in all states.
#[test]
fn help_names_each_control() {
    let mut unnamed = std::collections::BTreeSet::new();
    for name in sample::STATES {
        let mut window = window(sample::state(name, socam_chart::theme::Look::Dark).unwrap());
        until(&mut window, "a view", |window| !window.state().is_busy());
        window.run_steps(2);
        for node in window.root().children_recursive() {
            let node = node.accesskit_node();
            let is_control = matches!(
                node.role(),
                egui::Role::Button
                    | egui::Role::CheckBox
                    | egui::Role::Slider
                    | egui::Role::SpinButton
                    | egui::Role::ComboBox
                    | egui::Role::TextInput
            );
            let label = node.label().unwrap_or_default();
            // Recordings, channels and elements of the bench have names of their own.
            let is_theirs =
                [": ", ", V", ", rad/s", ", rpm", ", N m", ", W"].iter().any(|part| label.contains(part))
                    || (!label.contains(' ') && label.contains('.'));
            if is_control && !is_theirs && !socam_dashboard::help::names(&label) {
                unnamed.insert(label);
            }
        }
    }
    assert!(unnamed.is_empty(), "help says nothing of {unnamed:?}");
}

fn inside(window: &Harness<'static, Dashboard>, label: &str) -> egui::Rect {
    window.get_all_by_label(label).next().unwrap_or_else(|| panic!("{label} is not there")).rect()
}

/// The help is moved and enlarged at will, and never lies over the emergency stop.
#[test]
fn the_help_does_not_cover_the_emergency_stop() {
    for size in [[800.0, 600.0], [640.0, 420.0], [1280.0, 800.0]] {
        let mut window = with(View::Live, 0);
        window.set_size(size.into());
        window.key_press(egui::Key::F1);
        window.run_steps(4);
        let stop = inside(&window, "EMERGENCY STOP");
        let title = inside(&window, "What each control does");
        // Dragged towards the button.
        for (at, pressed) in [(title.center(), true), (stop.center(), false)] {
            window.hover_at(at);
            window.run_steps(1);
            window.event(egui::Event::PointerButton {
                pos: at,
                button: egui::PointerButton::Primary,
                pressed,
                modifiers: egui::Modifiers::NONE,
            });
            window.run_steps(3);
        }
        let title = inside(&window, "What each control does");
        assert!(title.top() >= stop.bottom(), "{size:?}: {title:?} covers {stop:?}");
        window.key_press(egui::Key::Escape);
        window.run_steps(2);
        assert!(window.query_by_label("What each control does").is_none(), "Esc closes the help");
    }
}

/// In every view the frame says what the watch says, and the title of the window does, too.
#[test]
fn the_state_of_the_watch_is_seen_in_every_view() {
    use socam_workbench::watch::{Tone, WatchState};
    let mut window = with(View::Time, 1);
    assert_eq!(window.state().title(), "socam: no board");
    window.state_mut().workspace.watch = Some(WatchState { text: "not judged".into(), tone: Tone::Quiet });
    for view in ["Live", "Time", "Frequency", "Check", "Identify", "Diagnosis"] {
        click(&mut window, view);
        window.get_by_label("Watch: not judged");
    }
    assert_eq!(window.state().title(), "socam: no board; watch: not judged");
    click(&mut window, "Watch: not judged");
    assert_eq!(window.state().layout.view, View::Watch);
}

/// A long step of a job takes more lines and no more width.
#[test]
fn a_job_does_not_widen_its_panel() {
    let width = |window: &Harness<'static, Dashboard>| window.state().layout.panels["findings"];
    let mut window = with(View::Diagnosis, 1);
    let before = width(&window);
    click(&mut window, "Diagnose");
    for _ in 0..20 {
        window.run_steps(1);
        std::thread::sleep(Duration::from_millis(5));
        assert!((width(&window) - before).abs() < 2.0, "{} after {before}", width(&window));
    }
    click(&mut window, "Cancel");
}

/// With more plots than the window has room for, the time axis is in sight at every place of the page.
#[test]
fn the_time_axis_stays_in_sight() {
    let mut window = with(View::Time, 1);
    window.get_by_label("Chart torque_out, N m");
    assert!(window.query_by_label("Axis time, s").is_none(), "plots that fit have their own axis");
    window.set_size([800.0, 420.0].into());
    window.run_steps(4);
    let axis = inside(&window, "Axis time, s");
    assert!(axis.bottom() <= 420.0 && axis.top() > 300.0, "{axis:?}");
}

#[test]
fn a_recording_that_was_closed_is_opened_again_by_undo() {
    let mut window = with(View::Time, 3);
    click(&mut window, "Close multisine-1.mcap");
    assert_eq!(window.state().workspace.entries.len(), 2);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    window.run_steps(3);
    let names: Vec<_> =
        window.state().workspace.entries.iter().map(|own| own.recording.about.name.clone()).collect();
    assert_eq!(names, ["runs/multisine-0.mcap", "runs/multisine-1.mcap", "runs/multisine-2.mcap"]);
}

/// Values that are missing are counted apart from gaps.
#[test]
fn missing_values_are_counted_and_are_no_gaps() {
    let mut dashboard = Dashboard::default();
    let time_s: Vec<f64> = (0..1000).map(|row| f64::from(row) * 1e-3).collect();
    let hole = |row: usize| if (400..411).contains(&row) { f64::NAN } else { (row as f64).sin() };
    let column: Vec<f64> = (0..1000).map(hole).collect();
    dashboard.add_recording(sample::of("holes.csv", time_s, vec![column]));
    let window = window(dashboard);
    window.get_by_label_contains("11 missing values");
    assert!(window.query_by_label_contains("gap").is_none());
}
