//! The live view, with a board that the test simulates.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use socam_chart::theme::Look;
use socam_core::State;
use socam_dashboard::Dashboard;
use socam_workbench::link::{Bench, News, Order};

use crate::clicks::{click, window};
use crate::sample::{self, bench};

type Window = Harness<'static, Dashboard>;

fn connected() -> (Window, Bench) {
    let (dashboard, bench) = bench::connected(Look::Dark);
    (window(dashboard), bench)
}

fn tell(window: &mut Window, bench: &Bench, news: News) {
    bench.news.send(news).unwrap();
    window.run_steps(3);
}

/// Texts in sight that contain these words.
fn texts(window: &Window, words: &str) -> usize {
    window.query_all_by_label_contains(words).count()
}

fn places(window: &Window) -> Vec<egui::Rect> {
    let is_no_text = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() == egui::Role::Button;
    let place = |label| window.get_all_by_label(label).find(is_no_text).unwrap().rect();
    ["Arm", "Run", "Stop", "EMERGENCY STOP"].map(place).to_vec()
}

/// Whatever is typed into the address, and when the link opens, the fields below it stay where they are.
#[test]
fn fields_below_the_address_never_move() {
    let top = |window: &Window| window.get_all_by_label("Name").next().unwrap().rect().top();
    let mut closed = window(sample::dashboard(Look::Dark, socam_dashboard::View::Live));
    let at = top(&closed);
    for address in ["udp:0.0.0.0:9870", "slcan:/dev/ttyACM0?bitrate=500k", "moteus:/dev/ttyACM0?id=1"] {
        closed.state_mut().workspace.device = address.into();
        closed.run_steps(3);
        assert_eq!(top(&closed), at, "{address}");
    }
    let (open, _bench) = connected();
    assert_eq!(top(&open), at, "connected");
}

#[test]
fn arm_run_and_stop_never_move() {
    for size in [[640.0, 420.0], [1280.0, 800.0]] {
        let resized = |dashboard| {
            let mut window = window(dashboard);
            window.set_size(size.into());
            window.run_steps(3);
            window
        };
        let mut closed = resized(sample::dashboard(Look::Dark, socam_dashboard::View::Live));
        let at = places(&closed);
        let inside = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        assert!(at.iter().all(|place| inside.contains_rect(*place)), "{at:?}");
        let long = "a message that is longer than a line ".repeat(20);
        closed.state_mut().warn(long.clone());
        closed.state_mut().warn("a second one");
        closed.run_steps(3);
        assert_eq!(places(&closed), at, "messages of the window");

        let (dashboard, bench) = bench::connected(Look::Dark);
        let mut window = resized(dashboard);
        for state in [State::Idle, State::Armed, State::Running, State::Stopping] {
            if state == State::Running {
                tell(&mut window, &bench, News::Began { path: long.clone().into(), planned_s: 600.0 });
            }
            tell(&mut window, &bench, bench::health(state, None));
            assert_eq!(places(&window), at, "{state}");
        }
        bench::samples().into_iter().for_each(|batch| bench.samples.push(batch));
        tell(&mut window, &bench, News::Problem(long.clone()));
        assert_eq!(places(&window), at, "a long error");
        tell(&mut window, &bench, bench::health(State::Fault, Some(&long)));
        assert_eq!(places(&window), at, "a long fault");
    }
}

#[test]
fn a_fault_is_one_line_until_it_is_cleared() {
    let mut window = window(bench::stopped(Look::Dark));
    window.run_steps(3);
    assert_eq!(texts(&window, "over-speed"), 1);
    assert_eq!(texts(&window, "then clear the fault"), 1);
    assert_eq!(window.state().problems().count(), 0);

    let (mut window, bench) = connected();
    tell(&mut window, &bench, bench::health(State::Fault, Some(bench::FAULT)));
    tell(&mut window, &bench, bench::health(State::Fault, Some(bench::FAULT)));
    assert_eq!(texts(&window, "over-speed"), 1);
    click(&mut window, "Clear fault");
    let orders: Vec<Order> = bench.orders.try_iter().collect();
    assert!(matches!(orders[..], [Order::Connect(_), Order::ClearFault]), "{orders:?}");
    tell(&mut window, &bench, bench::health(State::Idle, None));
    assert_eq!((texts(&window, "over-speed"), texts(&window, "Clear fault")), (0, 0));
    tell(&mut window, &bench, News::Problem("the profile is too long".into()));
    click(&mut window, "Dismiss");
    assert_eq!(texts(&window, "too long"), 0);
}

#[test]
fn keys_arm_run_and_stop_but_not_into_a_dialog() {
    let (mut window, bench) = connected();
    let keys = egui::Modifiers::COMMAND | egui::Modifiers::SHIFT;
    let press = |window: &mut Window, key| {
        window.key_press_modifiers(keys, key);
        window.run_steps(2);
        bench.orders.try_iter().last()
    };
    tell(&mut window, &bench, bench::health(State::Idle, None));
    assert!(press(&mut window, egui::Key::R).is_some_and(|order| matches!(order, Order::Connect(_))));
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::O);
    window.run_steps(2);
    assert!(press(&mut window, egui::Key::A).is_none());
    click(&mut window, "Cancel");
    assert!(matches!(press(&mut window, egui::Key::A), Some(Order::Arm(_))));
    tell(&mut window, &bench, bench::health(State::Armed, None));
    assert!(matches!(press(&mut window, egui::Key::R), Some(Order::Run)));
    tell(&mut window, &bench, bench::health(State::Running, None));
    press(&mut window, egui::Key::D);
    assert_eq!(bench.presses.load(std::sync::atomic::Ordering::SeqCst), 1);
}

#[test]
fn esc_puts_the_help_away_at_rest_and_stops_a_bench_that_is_armed() {
    let (mut window, bench) = connected();
    let presses = || bench.presses.load(std::sync::atomic::Ordering::SeqCst);
    for (state, expected) in [(State::Idle, false), (State::Armed, true)] {
        tell(&mut window, &bench, bench::health(state, None));
        window.key_press(egui::Key::F1);
        window.run_steps(2);
        assert!(window.state().help.is_open);
        window.key_press(egui::Key::Escape);
        window.run_steps(2);
        assert!(!window.state().help.is_open);
        assert_eq!(presses() > 0, expected, "{state:?}");
    }
}

#[test]
fn progress_numbers_gaps_and_events_are_in_words() {
    let mut window = window(bench::running(Look::Dark));
    window.run_steps(3);
    window.get_by_label("7.3 s of 10.2 s, 2.9 s left");
    window.get_by_label("400 samples missing in 1 gap");
    let speed = window.get_by_label_contains("motor_speed is ");
    let text = speed.accesskit_node().value().unwrap();
    assert!(text.contains(" rad/s; ") && text.contains(" to ") && text.contains("limit ±149.2"), "{text}");
    let kinds: Vec<_> =
        window.state().workspace.bench.events().iter().map(|event| event.kind.clone()).collect();
    assert_eq!(kinds, ["start", "note"]);
}

#[test]
fn a_held_picture_stands_still_and_loses_nothing() {
    let (mut window, bench) = connected();
    let batches = bench::samples();
    bench.samples.push(batches[0].clone());
    window.run_steps(2);
    click(&mut window, "Hold picture");
    batches[1..].iter().for_each(|batch| bench.samples.push(batch.clone()));
    window.run_steps(2);
    assert_eq!(texts(&window, "missing"), 0, "the held picture has no gap");
    click(&mut window, "Hold picture");
    window.get_by_label("400 samples missing in 1 gap");
    assert_eq!(window.state().workspace.bench.buffer().rows(), 7450);
}

/// A drive is armed only within limits, has the emergency stop like a board, and what it does not promise is said before.
#[test]
fn a_drive_is_armed_within_its_limits_and_stopped_by_every_stop() {
    let (dashboard, bench) = sample::source::at_rest(Look::Dark);
    let mut window = window(dashboard);
    let presses = || bench.presses.swap(0, std::sync::atomic::Ordering::SeqCst);
    window.run_steps(3);
    assert_eq!(texts(&window, "it coasts, and a weight falls"), 1);
    assert!(window.get_by_label("Arm").accesskit_node().is_disabled(), "no limit is set");
    window.state_mut().workspace.drive.set_speed(30.0);
    window.state_mut().workspace.drive.set_effort(socam_workbench::device::Effort::Torque, 0.5);
    window.run_steps(3);
    click(&mut window, "Arm");
    let Some(Order::Arm(plan)) = bench.orders.try_iter().last() else { panic!() };
    let limits = plan.limits.unwrap();
    assert_eq!((limits.speed_rad_s, limits.effort), (30.0, 0.5));
    assert!(plan.signal.command != socam_recording::ProfileCommand::Voltage && plan.signal.limit <= 30.0);
    for (state, stops) in [(State::Idle, 0), (State::Armed, 2), (State::Running, 2), (State::Stopping, 2)] {
        for view in ["Live", "Time", "Diagnosis"] {
            click(&mut window, view);
            tell(&mut window, &bench, bench::health(state, None));
            window.key_press(egui::Key::Escape);
            window.run_steps(2);
            let pressed = presses();
            assert!(pressed == stops || state == State::Idle, "{state:?} in {view}: {pressed}");
        }
    }
    tell(&mut window, &bench, bench::health(State::Running, None));
    click(&mut window, "EMERGENCY STOP");
    assert_eq!(presses(), 2);
    click(&mut window, "Live");
    click(&mut window, "Stop");
    assert_eq!(presses(), 1);
}
