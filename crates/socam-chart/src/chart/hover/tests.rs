use super::*;
use crate::chart::Style;

fn curve(parts: Vec<Vec<[f64; 2]>>) -> Curve {
    Curve { name: "c".into(), colour: Color32::RED, parts, style: Style::Solid }
}

#[test]
fn what_is_read_is_a_sample_or_says_that_it_is_many() {
    let line = curve(vec![vec![[0.0, 1.0], [1.0, 2.0], [2.0, -1.0], [2.0, 5.0]], vec![[5.0, 7.0]]]);
    assert_eq!(nearest(&line, 0.9, 0.1), Reading::At([1.0, 2.0]));
    assert_eq!(nearest(&line, 1.9, 0.1), Reading::Between(2.0, [-1.0, 5.0]));
    assert_eq!(nearest(&line, 3.5, 0.1), Reading::Nothing, "in a gap");
    assert_eq!(nearest(&line, 5.05, 0.1), Reading::At([5.0, 7.0]));
    assert_eq!(nearest(&curve(vec![vec![]]), 5.0, 0.1), Reading::Nothing);
}

#[test]
fn the_readout_is_inside_of_the_chart_and_not_over_the_pointer() {
    let frame = Rect::from_min_size(pos2(60.0, 20.0), vec2(500.0, 120.0));
    let size = vec2(180.0, 60.0);
    for x in (60..=560).step_by(20) {
        for y in (20..=140).step_by(10) {
            let pointer = pos2(x as f32, y as f32);
            let rect = place(frame, size, pointer);
            assert!(frame.contains_rect(rect), "{pointer:?}: {rect:?}");
            assert!(!rect.expand(4.0).contains(pointer), "{pointer:?}: {rect:?}");
        }
    }
    // In a chart that is too small, the text begins at the top left corner.
    assert_eq!(place(frame, vec2(600.0, 200.0), pos2(300.0, 60.0)).min, frame.min);
}

#[test]
fn values_have_five_digits_and_units() {
    assert_eq!(value_text(0.0), "0");
    assert_eq!(value_text(-1.347_21), "-1.3472");
    assert_eq!(value_text(12_345.678), "12346");
    assert_eq!(value_text(2.5e-7), "2.5000e-7");
    assert_eq!((unit("torque_in, N m"), unit("coherence")), ("N m", ""));
    assert_eq!(shortened(&format!("{}end.mcap", "long/".repeat(9))).chars().count(), LETTERS);
}
