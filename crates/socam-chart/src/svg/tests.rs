use egui::{RawInput, Rect, pos2, vec2};
use roxmltree::{Document, Node};

use super::*;
use crate::chart::{self, Chart, Curve};
use crate::heat::{Cells, Heat};
use crate::xy::Cloud;

/// Contents for exports of the charts that a function draws.
fn seen(draw: impl Fn(&mut egui::Ui, &mut Vec<Seen>)) -> Vec<Seen> {
    let ctx = egui::Context::default();
    let mut seen = Vec::new();
    let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(900.0, 700.0));
    let _ = ctx.run_ui(RawInput { screen_rect: Some(rect), ..RawInput::default() }, |ui| draw(ui, &mut seen));
    seen
}

fn line(name: &str, colour: Color32, height: f64, style: Style) -> Curve {
    let points = |from: i32, to: i32| {
        (from..to).map(|n| [f64::from(n) * 1e-3, height * (f64::from(n) * 0.05).sin()]).collect::<Vec<_>>()
    };
    Curve { name: name.into(), colour, parts: vec![points(0, 4000), points(6000, 10_000)], style }
}

fn stack(ui: &mut egui::Ui, out: &mut Vec<Seen>) {
    let colours = [theme::line(ui, 0), theme::line(ui, 1)];
    let mut first = Chart::new("a", "torque_in, N m", vec2(900.0, 200.0));
    first.x = [0.0, 10.0];
    first.y = [-2.0, 2.0];
    first.curves = vec![
        line("runs/one.mcap", colours[0], 1.5, Style::Solid),
        line("runs/two <b>.mcap", colours[1], 0.7, Style::Dashed),
    ];
    first.shaded = vec![([4.0, 6.0], colours[0].gamma_multiply(0.16))];
    first.flags = vec![chart::Flag::new(5.2, "fault: too fast", theme::alarm(ui))];
    first.show(ui, out);
    let mut second = Chart::new("b", "motor_speed, rad/s", vec2(900.0, 234.0));
    second.x = [0.0, 10.0];
    second.y = [-100.0, 100.0];
    second.x_label = "time, s".into();
    second.curves = vec![line("runs/one.mcap", colours[0], 90.0, Style::Solid)];
    second.show(ui, out);
}

/// Horizontal and vertical range of the path of a line. Its letters are those that `socam_plot` writes.
fn extent(path: &str) -> [f64; 4] {
    let (mut at, mut extent) = ([0.0; 2], [f64::MAX, f64::MIN, f64::MAX, f64::MIN]);
    let mut rest = path;
    while let Some(letter) = rest.chars().next() {
        let end = rest[1..].find(|c: char| c.is_ascii_alphabetic()).map_or(rest.len(), |end| end + 1);
        let mut numbers: Vec<f64> = Vec::new();
        let mut text = String::new();
        for c in rest[1..end].chars().chain([' ']) {
            if (c == ' ' || c == '-' || c == '.' && text.contains('.')) && !text.is_empty() {
                numbers.push(text.parse().unwrap());
                text.clear();
            }
            if c != ' ' {
                text.push(c);
            }
        }
        match (letter, numbers.as_slice()) {
            ('M', [x, y]) => at = [*x, *y],
            ('l', [x, y]) => at = [at[0] + x, at[1] + y],
            ('v', [y]) => at[1] += y,
            ('h', [x]) => at[0] += x,
            other => panic!("{other:?} in {path}"),
        }
        extent = [extent[0].min(at[0]), extent[1].max(at[0]), extent[2].min(at[1]), extent[3].max(at[1])];
        rest = &rest[end..];
    }
    extent
}

fn number(node: Node<'_, '_>, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

#[test]
fn every_curve_is_in_the_file_within_its_range() {
    let text = svg(&seen(stack), true).unwrap();
    let document = Document::parse(&text).unwrap();
    let frames: Vec<Node<'_, '_>> =
        document.descendants().filter(|node| node.has_tag_name("clipPath")).collect();
    let lines: Vec<&str> = document
        .descendants()
        .filter(|node| {
            let class = node.attribute("class").unwrap_or_default();
            node.has_tag_name("path") && class.starts_with("line c") && !class.contains("key")
        })
        .filter_map(|node| node.attribute("d"))
        .collect();
    assert_eq!((frames.len(), lines.len()), (2, 3));
    // Expected height of each curve, as a share of half of its axis.
    for (path, (frame, share)) in lines.iter().zip([(0, 0.75), (0, 0.35), (1, 0.9)]) {
        let frame = frames[frame].first_element_child().unwrap();
        let [left, right, top, bottom] = extent(path);
        let (x, y) = (number(frame, "x"), number(frame, "y"));
        let (width, height) = (number(frame, "width"), number(frame, "height"));
        assert!((left - x).abs() < 1.0 && (right - x - width).abs() < 1.0, "{left} {right}");
        let middle = y + 0.5 * height;
        let half = 0.5 * share * height;
        assert!((middle - half - top).abs() < 0.5 && (bottom - middle - half).abs() < 0.5, "{top} {bottom}");
        // The gap is not bridged.
        assert_eq!(path.matches('M').count(), 2);
    }
}

#[test]
fn axes_units_names_flags_and_gaps_are_in_the_file() {
    let text = svg(&seen(stack), true).unwrap();
    let document = Document::parse(&text).unwrap();
    let texts: Vec<&str> =
        document.descendants().filter(|n| n.has_tag_name("text")).filter_map(|n| n.text()).collect();
    for expected in
        ["torque_in (N m)", "motor_speed (rad/s)", "runs/one.mcap", "runs/two <b>.mcap", "fault: too fast"]
    {
        assert!(texts.contains(&expected), "{expected} is not in {texts:?}");
    }
    // The upper chart has the label of the lower one, whose range it shares.
    assert_eq!(texts.iter().filter(|text| **text == "time (s)").count(), 2);
    let gap = document
        .descendants()
        .find(|n| n.attribute("class").is_some_and(|c| c.starts_with("shade")))
        .unwrap();
    let frame =
        document.descendants().find(|n| n.has_tag_name("clipPath")).unwrap().first_element_child().unwrap();
    let share = (number(gap, "x") - number(frame, "x")) / number(frame, "width");
    assert!((share - 0.4).abs() < 0.002, "{share}");
    assert!(svg(&[], true).is_err());
}

#[test]
fn a_zoomed_chart_is_cut_off_and_keeps_its_slopes() {
    let zoomed = |ui: &mut egui::Ui, out: &mut Vec<Seen>| {
        let mut chart = Chart::new("a", "x, V", vec2(900.0, 200.0));
        (chart.x, chart.y) = ([0.0, 1.0], [0.0, 1.0]);
        let parts = vec![vec![[-1.0, -2.0], [2.0, 4.0]]];
        chart.curves = vec![Curve { name: "c".into(), colour: Color32::RED, parts, style: Style::Solid }];
        chart.show(ui, out);
    };
    let text = svg(&seen(zoomed), true).unwrap();
    let document = Document::parse(&text).unwrap();
    let is_line = |n: &Node<'_, '_>| {
        n.attribute("class").is_some_and(|c| c.starts_with("line c") && !c.contains("key"))
    };
    let line = document.descendants().find(is_line).unwrap();
    let frame = document.descendants().find(|n| n.has_tag_name("clipPath")).unwrap();
    let [left, right, top, bottom] = extent(line.attribute("d").unwrap());
    let rect = frame.first_element_child().unwrap();
    let (width, height) = (number(rect, "width"), number(rect, "height"));
    assert!(((right - left) / width - 3.0).abs() < 0.01 && ((bottom - top) / height - 6.0).abs() < 0.01);
    let clip = line.ancestors().find_map(|n| n.attribute("clip-path")).unwrap();
    assert_eq!(clip, format!("url(#{})", frame.attribute("id").unwrap()));
}

#[test]
fn dots_and_fields_have_their_bars() {
    let coloured = |ui: &mut egui::Ui, out: &mut Vec<Seen>| {
        let mut chart = Chart::new("a", "torque, N m", vec2(900.0, 200.0));
        let colours = Colours::of_dots(ui, [0.0, 10.0], "time, s");
        let dots = (0..100).map(|n| [f64::from(n) * 0.01, 0.5, f64::from(n) * 0.1]).collect();
        chart.backdrop = Some(Backdrop::Cloud(Cloud { dots, colours }));
        chart.show(ui, out);
        let mut chart = Chart::new("b", "frequency, Hz", vec2(900.0, 200.0));
        let cells = Cells { x: [0.0, 1.0], y: [0.0, 1.0], rows: 2, values: vec![1.0, 2.0, f64::NAN, 3.0] };
        let colours = Colours::of_fields([1.0, 3.0], "density, dB");
        chart.backdrop = Heat::new(ui.ctx(), "field", cells, colours).map(Backdrop::Heat);
        chart.show(ui, out);
    };
    let text = svg(&seen(coloured), true).unwrap();
    let document = Document::parse(&text).unwrap();
    let texts: Vec<&str> = document.descendants().filter_map(|n| n.text()).collect();
    assert!(texts.contains(&"time (s)") && texts.contains(&"density (dB)"), "{texts:?}");
    let speckles = document
        .descendants()
        .filter_map(|n| n.attribute("class").filter(|c| c.contains("speckle")).and(n.attribute("d")));
    assert_eq!(speckles.map(|path| path.matches('M').count()).sum::<usize>(), 100);
    let image = document.descendants().find(|n| n.has_tag_name("image")).unwrap();
    assert!(image.attribute("href").unwrap().starts_with("data:image/png;base64,iVBOR"));
}
