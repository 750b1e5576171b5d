//! The whole job by keys alone: a recording is opened, its machine described, diagnosed, and the report saved.

use crate::clicks::{until, window};
use egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use socam_dashboard::{Dashboard, View};

const CTRL: Modifiers = Modifiers::COMMAND;

type Window = Harness<'static, Dashboard>;

fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(3);
}

/// Types into whatever has the keyboard.
fn write(window: &mut Window, text: &str) {
    window.event(Event::Text(text.into()));
    window.run_steps(2);
}

/// A slide of 12 kg with damping and Coulomb friction, pushed by two sines, as a table.
fn pushed_slide(seed: u64) -> String {
    let (mass, damping, friction, step_s) = (12.0, 60.0, 4.0, 1e-4);
    let (mut x, mut v, mut state) = (0.0_f64, 0.0_f64, seed);
    let mut text = "t_s,force_N,position_m\n".to_owned();
    for step in 0..40_000 {
        let t = f64::from(step) * step_s;
        let force = 40.0 * (6.0 * t).sin() + 25.0 * (17.0 * t + seed as f64).sin();
        if step % 50 == 0 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let noise = 2e-6 * ((state >> 40) as f64 / f64::from(1_u32 << 24) - 0.5);
            text += &format!("{t:.4},{force:.6},{:.9}\n", x + noise);
        }
        v += step_s * (force - damping * v - friction * (v / 1e-3).tanh()) / mass;
        x += step_s * v;
    }
    text
}

#[test]
fn a_table_becomes_a_report_without_a_mouse() {
    let folder = tempfile::tempdir().unwrap();
    for (seed, name) in [(1, "first.csv"), (2, "second.csv")] {
        std::fs::write(folder.path().join(name), pushed_slide(seed)).unwrap();
    }
    let mut dashboard = Dashboard::default();
    dashboard.layout.folder = folder.path().into();
    let mut window = window(dashboard);
    for name in ["first", "second"] {
        press(&mut window, CTRL, Key::O);
        write(&mut window, name);
        press(&mut window, Modifiers::NONE, Key::Enter);
        until(&mut window, "the recording", |window| !window.state().is_busy());
        window.run_steps(2);
    }
    assert_eq!(window.state().workspace.entries.len(), 2);
    press(&mut window, CTRL | Modifiers::SHIFT, Key::N);
    for words in ["slide 10kg", "force@slide:force_N", "position@slide:position_m"] {
        press(&mut window, CTRL, Key::A);
        write(&mut window, words);
        press(&mut window, Modifiers::NONE, Key::Tab);
    }
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(
        window.state().workspace.model().parameters.len(),
        2,
        "{}",
        window.state().workspace.model().text
    );
    window.get_by_label_contains("machine is the model now");
    press(&mut window, CTRL, Key::Num6);
    assert_eq!(window.state().layout.view, View::Diagnosis);
    press(&mut window, CTRL, Key::Enter);
    window.get_by_label("A diagnosis runs");
    until(&mut window, "the diagnosis", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label_contains("Coulomb friction at slide_guide");
    // A remark goes by itself.
    let remark = "machine is the model now";
    until(&mut window, "the remark", |window| window.query_by_label_contains(remark).is_none());
    press(&mut window, CTRL, Key::P);
    press(&mut window, Modifiers::NONE, Key::Enter);
    until(&mut window, "the report", |window| !window.state().is_busy());
    assert!(folder.path().join("diagnosis/index.html").is_file());
}
