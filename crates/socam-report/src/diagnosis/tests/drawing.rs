//! Tests of the drawings on a page: the bench with its marks, and the text of every picture.

use socam_findings::Evidence;
use socam_model::Model;

use super::{reader::report, sample};

/// Two windings and two differentials.
const WRIST: &str = include_str!("../../../../socam-model/tests/wrist.toml");
/// A branch at the hub, two shafts side by side, and a spring to the ground.
const BRANCHES: &str = include_str!("../../../../socam-model/tests/branches.toml");

#[test]
fn every_builtin_model_is_drawn() {
    for (name, text) in socam_model::BUILTIN.iter().chain(&[("branches", BRANCHES), ("wrist", WRIST)]) {
        let model = Model::parse(text).unwrap();
        let mut diagnosis = sample::diagnosis();
        // Both a bearing and a channel, so that marks meet.
        let bearing = model.bearings.first().map_or("held", |bearing| &bearing.name);
        diagnosis.findings[0].location = bearing.into();
        diagnosis.findings[1].location = model.channels[0].name.clone();
        diagnosis.findings.push(sample::unexplained());
        diagnosis.findings[2].location = bearing.into();
        report(&format!("model-{name}"), &diagnosis, &Evidence::default(), &model);
    }
}

/// Mean width of a letter of 11 points in common fonts: less than the widest letter, so that only real overlaps count.
const LETTER_WIDTH: f64 = 5.6;

/// Asserts that no text of a picture lies on another.
pub(super) fn assert_texts_apart(page: &str, svg: &roxmltree::Node<'_, '_>) {
    let boxes: Vec<_> = svg.descendants().filter_map(|node| text_box(&node)).collect();
    for (index, (text, [left, top, right, bottom])) in boxes.iter().enumerate() {
        for (other, [other_left, other_top, other_right, other_bottom]) in &boxes[index + 1..] {
            let apart =
                right <= other_left || other_right <= left || bottom <= other_top || other_bottom <= top;
            assert!(apart, "{page}, {:?}: `{text}` and `{other}`", svg.attribute("aria-label"));
        }
    }
}

/// A text and the room that it takes.
fn text_box(node: &roxmltree::Node<'_, '_>) -> Option<(String, [f64; 4])> {
    let text = node.text().filter(|_| node.has_tag_name("text"))?;
    let number = |name| node.attribute(name).and_then(|value| value.parse::<f64>().ok());
    let size = if node.attribute("class") == Some("letter") { 17.0 } else { 11.0 };
    let width = LETTER_WIDTH / 11.0 * size * text.chars().count() as f64;
    let before = match node.attribute("text-anchor") {
        Some("middle") => 0.5 * width,
        Some("end") => width,
        _ => 0.0,
    };
    let Some(turned) = node.attribute("transform") else {
        let (x, y) = (number("x")?, number("y")?);
        return Some((text.to_owned(), [x - before, y - 0.75 * size, x - before + width, y + 0.2 * size]));
    };
    // The title of a vertical axis, which is turned by a quarter.
    let place = turned.strip_prefix("translate(")?.split(')').next()?;
    let (x, y) = place.split_once(' ')?;
    let (x, y): (f64, f64) = (x.parse().ok()?, y.parse().ok()?);
    Some((text.to_owned(), [x - 0.75 * size, y - before, x + 0.2 * size, y - before + width]))
}
