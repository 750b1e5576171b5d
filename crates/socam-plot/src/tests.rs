use super::*;

fn plot<'a>(x: &'a [f64], y: &'a [f64], mark: Mark) -> Plot<'a> {
    Plot {
        title: "test".into(),
        x: Axis::new("Time", "s"),
        y: Axis::new("Residual", "N m"),
        series: vec![Series { label: "before", class: "before", mark, x, y, spread: &[] }],
        columns: COLUMNS,
    }
}

fn svg(plot: &Plot<'_>) -> String {
    let text = plot.render().into_string();
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    roxmltree::Document::parse(&text).unwrap();
    text
}

fn labels(axis: &Axis, values: &[f64]) -> Vec<String> {
    let values = values.iter().copied();
    axis.scale(values, (0.0, 350.0)).ticks().map(|tick| tick.label).collect()
}

#[test]
fn ticks_are_round() {
    assert_eq!(labels(&Axis::new("t", "s"), &[0.0, 9.999]), ["0", "2", "4", "6", "8"]);
    assert_eq!(labels(&Axis::new("t", "s"), &[-0.29, 0.31]), ["−0.2", "−0.1", "0.0", "0.1", "0.2", "0.3"]);
    assert_eq!(labels(&Axis::new("t", "s"), &[0.0, 5e-5]), ["0", "10", "20", "30", "40", "50"]);
    assert_eq!(labels(&Axis::new("t", "s"), &[100.0, 100.0]), ["90", "95", "100", "105", "110"]);
    assert_eq!(labels(&Axis::logarithmic("f", "Hz"), &[0.1, 500.0]), ["0.1", "1", "10", "100"]);
    assert_eq!(labels(&Axis::logarithmic("f", "Hz"), &[3.0, 30.0]), ["5", "10", "20"]);
}

#[test]
fn the_power_of_ten_is_in_the_title() {
    let axis = Axis::new("Residual", "N m2");
    let scale = axis.scale([0.0, 5e-5].into_iter(), (0.0, 350.0));
    assert_eq!(axis.title(&scale), "Residual (10⁻⁶ N m²)");
}

#[test]
fn a_spike_of_one_sample_survives() {
    let x: Vec<f64> = (0..100_000).map(f64::from).collect();
    let mut y = vec![0.0; x.len()];
    y[54_321] = 1.0;
    let text = svg(&plot(&x, &y, Mark::Trace));
    assert!(text.len() < 20_000, "{} bytes", text.len());
    let spikes = text.matches("v-").count();
    assert!(spikes == 1, "{spikes}");
}

#[test]
fn gaps_are_not_bridged() {
    let moves = |x: &[f64], y: &[f64], mark| {
        let text = svg(&plot(x, y, mark));
        let (_, line) = text.split_once("class=\"line before\" d=\"").unwrap();
        line.split('"').next().unwrap().matches('M').count()
    };
    let x: Vec<f64> = (0..50).map(|n| f64::from(n) + if n >= 25 { 30.0 } else { 0.0 }).collect();
    let mut y: Vec<f64> = x.iter().map(|x| x.sin()).collect();
    assert_eq!(moves(&x, &y, Mark::Trace), 2);
    assert_eq!(moves(&x, &y, Mark::Line), 1);
    y[10] = f64::NAN;
    assert_eq!(moves(&x, &y, Mark::Trace), 3);
}

#[test]
fn odd_data_are_drawn_or_said() {
    assert!(svg(&plot(&[], &[], Mark::Line)).contains("no data"));
    assert!(svg(&plot(&[0.0], &[f64::NAN], Mark::Line)).contains("no data"));
    for mark in [Mark::Line, Mark::Trace, Mark::Circles, Mark::Squares] {
        assert!(svg(&plot(&[3.0], &[2.0], mark)).contains("<svg"));
        svg(&plot(&[0.0, 1.0], &[1e308, -1e308], mark));
        svg(&plot(&[0.0, 1.0, 2.0], &[1e-300, f64::INFINITY, 1e99], mark));
        let mut logarithmic = plot(&[0.0, 1.0, 2.0], &[0.0, -1.0, 5.0], mark);
        logarithmic.x.logarithmic = true;
        logarithmic.y.logarithmic = true;
        svg(&logarithmic);
    }
}

#[test]
fn a_file_of_its_own_needs_no_page() {
    let file = standalone(&plot(&[0.0, 1.0], &[2.0, 3.0], Mark::Line));
    let document = roxmltree::Document::parse(&file).unwrap();
    let style = document.descendants().find(|node| node.has_tag_name("style")).unwrap().text().unwrap();
    assert!(style.contains(".before { stroke: #b34700; }") && !style.contains("var("), "{style}");
    let row = || Row {
        title: "a <b> & c".into(),
        panels: [plot(&[0.0, 1.0], &[2.0, 3.0], Mark::Crosses), plot(&[], &[], Mark::Line)]
            .map(Panel::Plot)
            .into(),
    };
    let file = sheet("two", &[row(), row()]);
    let document = roxmltree::Document::parse(&file).unwrap();
    let said = |text: &str| document.descendants().filter(|node| node.text() == Some(text)).count();
    assert!(said("a <b> & c") >= 2 && file.contains("no data"), "{file}");
}

#[test]
fn colours_have_axes_and_a_bar() {
    let heat = Heat {
        title: "a & b".into(),
        x: (Axis::new("Speed", "rad/s"), 120.0),
        y: (Axis::new("Torque", "N m"), 0.1),
        value: Axis::new("Efficiency", "%"),
        colours: [80.0, 95.0],
        size: [3, 2],
        cells: vec![
            Cell { column: 0, row: 0, value: 80.0 },
            Cell { column: 2, row: 1, value: 99.0 },
            Cell { column: 1, row: 1, value: f64::NAN },
        ],
        contours: vec![Contour { level: Heat::levels([80.0, 95.0])[1], ends: [[0.0, 0.02], [120.0, 0.08]] }],
        dots: &[[60.0, 0.05]],
    };
    let text = sheet("map", &[Row { title: "first".into(), panels: vec![Panel::Heat(heat.clone())] }]);
    roxmltree::Document::parse(&text).unwrap();
    assert!(
        !text.contains("NaN") && text.contains("Efficiency (%)") && text.contains("Torque (N m)"),
        "{text}"
    );
    // The ends of the colours, each once in a cell and beyond it in the bar.
    assert!(text.contains("#440154") && text.contains("#fde725"), "{text}");
    assert_eq!(text.matches("class=\"contour\"").count(), 1);
    let empty = Heat { cells: Vec::new(), ..heat };
    let text = sheet("map", &[Row { title: "first".into(), panels: vec![Panel::Heat(empty)] }]);
    assert!(text.contains("a &amp; b: no data"), "{text}");
}
