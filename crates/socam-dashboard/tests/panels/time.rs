//! Plots as tiles: dragged, joined, derived, measured, saved; and lists of many recordings.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use socam_dashboard::{Dashboard, Layout, View};
use socam_workbench::arrangement::Plot;
use socam_workbench::derivation::{Derivation, Operation};

use crate::clicks::{click, copied, has, press, until, window, with};
use crate::sample;

type Window = Harness<'static, Dashboard>;

fn place(window: &Window, label: &str) -> Rect {
    window.get_by_label(label).rect()
}

/// Presses at one place, moves to another one, and releases there.
pub(crate) fn drag(window: &mut Window, from: Pos2, to: Pos2) {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    window.event(Event::PointerMoved(from));
    window.run_steps(2);
    window.event(button(from, true));
    window.run_steps(1);
    for share in [0.1, 0.5, 0.9, 1.0] {
        window.event(Event::PointerMoved(from + share * (to - from)));
        window.run_steps(2);
    }
    window.event(button(to, false));
    window.run_steps(3);
}

#[test]
fn a_channel_is_dragged_into_a_plot_of_its_unit_and_to_the_edge_of_another() {
    let mut window = with(View::Time, 1);
    let [list, plot] = ["output_speed, rad/s", "Chart motor_speed, rad/s"].map(|label| place(&window, label));
    drag(&mut window, list.center(), plot.center());
    let both = "Chart motor_speed and output_speed (diamonds), rad/s";
    assert!(has(&window, both) && !has(&window, "Chart output_speed, rad/s"));
    // Another unit has an axis at the right; a third one is refused in a sentence, and nothing changes.
    let [list, plot] = ["command, V", both].map(|label| place(&window, label));
    drag(&mut window, list.center(), plot.center());
    let both = "Chart motor_speed and output_speed (diamonds) and command (squares, right axis), rad/s";
    assert!(has(&window, both) && !has(&window, "Chart command, V"));
    window.run_steps(40);
    let [list, plot] = ["torque_in, N m", both].map(|label| place(&window, label));
    drag(&mut window, list.center(), plot.center());
    window.get_by_label_contains("torque_in is in N m and this plot has axes in rad/s and V");
    click(&mut window, "Dismiss");
    // A channel that is dropped at the right edge gets a plot beside the existing one.
    let [list, plot] = ["torque_in, N m", both].map(|label| place(&window, label));
    drag(&mut window, list.center(), plot.right_center() - vec2(30.0, 0.0));
    let [beside, plot] = ["Chart torque_in, N m", both].map(|label| place(&window, label));
    assert!(beside.left() >= plot.right() && (beside.center().y - plot.center().y).abs() < 20.0);
    for _ in 0..3 {
        window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        window.run_steps(3);
    }
    assert!(has(&window, "Chart motor_speed, rad/s") && has(&window, "Chart output_speed, rad/s"));
    for _ in 0..2 {
        window.key_press_modifiers(Modifiers::COMMAND, Key::Y);
        window.run_steps(3);
    }
    assert!(has(&window, both));
}

#[test]
fn a_plot_is_moved_by_its_handle_and_closed() {
    let mut window = with(View::Time, 1);
    let plot = place(&window, "Chart command, V");
    window.event(Event::PointerMoved(plot.center()));
    window.run_steps(2);
    let grip = place(&window, "Move command").center();
    let target = place(&window, "Chart torque_out, N m");
    drag(&mut window, grip, target.left_center() + vec2(0.25 * target.width(), 0.0));
    let [moved, target] = ["Chart command, V", "Chart torque_out, N m"].map(|label| place(&window, label));
    assert!(moved.right() <= target.left() + 1.0, "{moved:?} {target:?}");
    window.event(Event::PointerMoved(moved.center()));
    window.run_steps(2);
    click(&mut window, "Close the plot command");
    assert!(!has(&window, "Chart command, V"));
    click(&mut window, "command, V");
    assert!(has(&window, "Chart command, V"));
}

#[test]
fn a_channel_is_derived_in_the_dialog_and_measured_in_the_table() {
    let mut window = with(View::Time, 1);
    press(&mut window, Key::D);
    window.get_by_label("Derive a channel");
    click(&mut window, "Add channel");
    until(&mut window, "the derivative", |window| !window.state().is_busy());
    // Changes within 0.6 s are one step of undo.
    window.run_steps(40);
    assert!(has(&window, "Chart command.derivative, V/s"));
    let power = Derivation {
        operation: Operation::Product,
        of: "torque_in".into(),
        second: Some("motor_speed".into()),
        ..Derivation::default()
    };
    window.state_mut().views.time.derive(power);
    until(&mut window, "the power", |window| !window.state().is_busy());
    window.run_steps(40);
    assert!(has(&window, "Chart torque_in.times.motor_speed, W"));
    // Undo takes the channel back, and redo computes it again.
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(3);
    assert!(!has(&window, "Chart torque_in.times.motor_speed, W"));
    window.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    until(&mut window, "the power", |window| has(window, "Chart torque_in.times.motor_speed, W"));
    click(&mut window, "Remove command.derivative");
    assert!(!has(&window, "Chart command.derivative, V/s"));
    press(&mut window, Key::T);
    click(&mut window, "Sort by mean");
    let table = copied(&mut window, "Copy table");
    let mut lines = table.lines();
    assert_eq!(
        lines.next(),
        Some("recording\tchannel\tunit\tsamples\tmean\tstd\trms\tmin\tmax\tpeak to peak")
    );
    let power = lines.find(|line| line.contains("torque_in.times.motor_speed")).unwrap();
    let cells: Vec<&str> = power.split('\t').collect();
    assert_eq!((cells[2], cells[3]), ("W", "4000"), "{power}");
    let mean: f64 = cells[4].parse().unwrap();
    let run = sample::run(0, 4000).samples;
    let product = run.values(3, 0..4000).into_iter().zip(run.values(1, 0..4000)).map(|(a, b)| a * b);
    assert!((mean - product.sum::<f64>() / 4000.0).abs() < 1e-4, "{power}");
}

#[test]
fn xy_plots_and_spectrograms_are_computed_and_drawn() {
    let mut window = with(View::Time, 2);
    press(&mut window, Key::X);
    press(&mut window, Key::G);
    until(&mut window, "the pictures", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label("Chart torque_out over command, N m");
    window.get_by_label("Chart frequency of command in multisine-0.mcap, Hz");
}

#[test]
fn a_layout_is_saved_under_a_name_and_opened_like_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let mut dashboard = Dashboard::default();
    dashboard.add_recording(sample::run(0, 4000));
    dashboard.layout.folder = folder.path().into();
    let mut window = window(dashboard);
    window.state_mut().views.time.add(Plot::Statistics);
    click(&mut window, "command, V");
    let kept = window.state().views.time.arrangement();
    click(&mut window, "Layout");
    click(&mut window, "Save layout...");
    click(&mut window, "Save");
    let path = folder.path().join("plots.layout.json").display().to_string();
    click(&mut window, "Layout");
    click(&mut window, "One plot per channel");
    assert!(has(&window, "Chart command, V"));
    window.state_mut().open([path]);
    until(&mut window, "the layout", |window| !window.state().is_busy());
    window.run_steps(2);
    assert_eq!(window.state().views.time.arrangement(), kept);
    assert!(!has(&window, "Chart command, V"));
    // The last one is that of the next start.
    let layout: Layout =
        serde_json::from_str(&serde_json::to_string(&window.state().layout).unwrap()).unwrap();
    assert_eq!(Dashboard::new(layout).views.time.arrangement(), kept);
}

#[test]
fn thirty_recordings_are_searched_shown_alone_and_keep_their_colours() {
    let mut dashboard = Dashboard::default();
    (0..30).for_each(|number| dashboard.add_recording(sample::run(number, 200)));
    let mut window = window(dashboard);
    let shown =
        |window: &Window| window.state().workspace.shown().map(|(number, _)| number).collect::<Vec<_>>();
    let row = place(&window, "multisine-7.mcap").height();
    assert!(row < 24.0, "a row is one line, not {row} points");
    window.key_press_modifiers(Modifiers::COMMAND, Key::F);
    window.run_steps(2);
    window.get_by_label("Search").type_text("sine-2");
    window.run_steps(3);
    assert!(has(&window, "multisine-2.mcap") && has(&window, "multisine-29.mcap"));
    assert!(!has(&window, "multisine-7.mcap") && !has(&window, "torque_out, N m"));
    click(&mut window, "Clear search");
    click(&mut window, "Close multisine-0.mcap");
    assert_eq!(shown(&window), (1..30).collect::<Vec<_>>(), "the others keep their numbers");
    click(&mut window, "More about multisine-7.mcap");
    click(&mut window, "Only this one");
    assert_eq!(shown(&window), [7]);
    window.state_mut().add_recording(sample::run(99, 200));
    window.run_steps(2);
    assert_eq!(shown(&window), [7, 0], "a new recording has the first free colour");
}
