//! Operations of users on charts, and their visible results.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, pos2, vec2};
use egui_kittest::Harness;

use super::*;

/// Two charts below each other, as a view of the dashboard has them.
#[derive(Default)]
struct Stack {
    x: Option<[f64; 2]>,
    y: Option<[f64; 2]>,
    height: f64,
    hover: hover::Linked,
    frames: Vec<Rect>,
    copied: bool,
    saved: Option<std::sync::Arc<egui::ColorImage>>,
}

impl Stack {
    fn ui(&mut self, ui: &mut Ui) {
        self.frames.clear();
        let x = self.x.unwrap_or([0.0, 10.0]);
        for (number, height) in [1.0, self.height].into_iter().enumerate() {
            let mut chart =
                Chart::new(("chart", number), format!("signal_{number}, N m"), vec2(600.0, 200.0));
            chart.x = x;
            chart.y = self.y.filter(|_| number == 0).unwrap_or([-height, height]);
            chart.x_label = if number == 1 { "time, s".into() } else { String::new() };
            let wave = (0..1000).map(|n| [f64::from(n) * 0.01, 0.5 * height * (f64::from(n) * 0.01).sin()]);
            let colour = theme::line(ui, number);
            chart.curves =
                vec![Curve { name: "r".into(), colour, parts: vec![wave.collect()], style: Style::Solid }];
            chart.hover = self.hover.at();
            let shown = chart.show(ui, &mut Vec::new());
            self.hover.take(&shown);
            self.frames.push(shown.frame);
            if shown.x_moved {
                self.x = Some(shown.x);
            }
            if shown.y_moved && number == 0 {
                self.y = Some(shown.y);
            }
            self.saved = take_picture(ui.ctx()).or(self.saved.take());
        }
        self.hover.end(ui.ctx());
        self.copied |= ui.output(|output| {
            output.commands.iter().any(|command| matches!(command, egui::OutputCommand::CopyImage(_)))
        });
    }
}

fn window(height: f64) -> Harness<'static, Stack> {
    let stack = Stack { height, ..Stack::default() };
    let builder = Harness::builder().with_size(vec2(640.0, 480.0)).with_step_dt(0.02);
    let mut window = builder.build_ui_state(|ui, stack: &mut Stack| stack.ui(ui), stack);
    window.run_steps(3);
    window
}

fn button(window: &mut Harness<'static, Stack>, pos: Pos2, pressed: bool) {
    let event =
        Event::PointerButton { pos, button: PointerButton::Secondary, pressed, modifiers: Modifiers::NONE };
    window.event(event);
    window.run_steps(2);
}

/// Presses the right button and moves, without release.
fn drag(window: &mut Harness<'static, Stack>, from: Pos2, to: Pos2) {
    window.hover_at(from);
    window.run_steps(1);
    button(window, from, true);
    for share in [0.5, 1.0] {
        window.hover_at(from + share * (to - from));
        window.run_steps(1);
    }
}

/// A position in the first chart by shares of its frame.
fn inside(window: &Harness<'static, Stack>, x: f32, y: f32) -> Pos2 {
    let frame = window.state().frames[0];
    frame.min + vec2(x * frame.width(), y * frame.height())
}

#[test]
fn a_box_zooms_to_what_is_in_it() {
    let mut window = window(1.0);
    let (from, to) = (inside(&window, 0.2, 0.25), inside(&window, 0.6, 0.75));
    drag(&mut window, from, to);
    button(&mut window, to, false);
    let ([x0, x1], [y0, y1]) = (window.state().x.unwrap(), window.state().y.unwrap());
    assert!((x0 - 2.0).abs() < 0.02 && (x1 - 6.0).abs() < 0.02, "{x0} {x1}");
    assert!((y0 + 0.5).abs() < 0.01 && (y1 - 0.5).abs() < 0.01, "{y0} {y1}");
}

#[test]
fn a_box_that_leaves_its_chart_ends_at_the_edge() {
    let mut window = window(1.0);
    let (from, outside) = (inside(&window, 0.5, 0.5), pos2(5000.0, -300.0));
    drag(&mut window, from, outside);
    button(&mut window, outside, false);
    let ([x0, x1], [y0, y1]) = (window.state().x.unwrap(), window.state().y.unwrap());
    assert!((x0 - 5.0).abs() < 0.02 && (x1 - 10.0).abs() < 1e-6, "{x0} {x1}");
    assert!(y0.abs() < 0.01 && (y1 - 1.0).abs() < 1e-6, "{y0} {y1}");
    // Nothing of the box is left: a drag with the left button pans and does not zoom.
    let from = inside(&window, 0.5, 0.5);
    for (pos, pressed) in
        [(from, Some(true)), (from + vec2(30.0, 0.0), None), (from + vec2(30.0, 0.0), Some(false))]
    {
        window.hover_at(pos);
        if let Some(pressed) = pressed {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            window.event(Event::PointerButton { pos, button, pressed, modifiers });
        }
        window.run_steps(2);
    }
    let panned = window.state().x.unwrap();
    assert!((panned[1] - panned[0] - (x1 - x0)).abs() < 1e-6 && panned[0] < x0, "{panned:?}");
}

#[test]
fn a_pointer_that_leaves_the_window_ends_the_box_where_it_was_seen() {
    let mut window = window(1.0);
    let (from, to) = (inside(&window, 0.2, 0.5), inside(&window, 0.7, 0.5));
    drag(&mut window, from, to);
    window.event(Event::PointerGone);
    window.run_steps(1);
    button(&mut window, to, false);
    let [x0, x1] = window.state().x.unwrap();
    assert!((x0 - 2.0).abs() < 0.02 && (x1 - 7.0).abs() < 0.02, "{x0} {x1}");
    assert_eq!(window.state().y, None, "a flat box zooms the horizontal axis only");
}

#[test]
fn escape_cancels_a_box() {
    let mut window = window(1.0);
    let (from, to) = (inside(&window, 0.2, 0.2), inside(&window, 0.6, 0.8));
    drag(&mut window, from, to);
    window.key_press(Key::Escape);
    window.run_steps(1);
    button(&mut window, to, false);
    assert_eq!((window.state().x, window.state().y), (None, None));
}

#[test]
fn charts_below_each_other_align_however_long_their_numbers_are() {
    for height in [1.0, 123_456.0, 3.3e-9] {
        let window = window(height);
        let [a, b] = [window.state().frames[0], window.state().frames[1]];
        assert_eq!((a.left(), a.right()), (b.left(), b.right()), "numbers up to {height}");
    }
}

#[test]
fn the_position_of_the_pointer_is_that_of_all_charts_of_a_stack() {
    let mut window = window(1.0);
    assert_eq!(window.state().hover.at(), None);
    let at = inside(&window, 0.3, 0.5);
    window.hover_at(at);
    window.run_steps(3);
    assert!((window.state().hover.at().unwrap() - 3.0).abs() < 0.02);
    window.hover_at(pos2(630.0, 470.0));
    window.run_steps(3);
    assert_eq!(window.state().hover.at(), None);
}

#[test]
fn a_chart_gives_its_picture_to_the_clipboard_and_for_a_file() {
    use egui_kittest::kittest::Queryable;
    for (label, saves) in [("Copy picture of this chart", false), ("Save picture of this chart...", true)] {
        let mut window = window(1.0);
        let at = inside(&window, 0.5, 0.5);
        window.hover_at(at);
        button(&mut window, at, true);
        button(&mut window, at, false);
        window.get_by_label(label).click();
        // The picture is given away in the pass of the click.
        window.run_steps(2);
        let stack = window.state();
        assert_eq!((stack.copied, stack.saved.is_some()), (!saves, saves), "{label}");
        if let Some(image) = &stack.saved {
            assert_eq!(image.size, [600, 200]);
            let is_blue = |pixel: &&Color32| i32::from(pixel.b()) - i32::from(pixel.r()) > 80;
            assert!(image.pixels.iter().filter(is_blue).count() > 300, "the curve is missing");
        }
    }
}

#[test]
fn many_curves_let_each_other_through_and_few_do_not() {
    assert_eq!((opacity(0), opacity(6)), (1.0, 1.0));
    assert!(opacity(24) == 0.5 && opacity(10_000) == 0.2);
}
