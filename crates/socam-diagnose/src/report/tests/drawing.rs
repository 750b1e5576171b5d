//! Tests of the drawing of the bench.

use socam_model::Model;

use super::{AALTO, report, sample, speed_o_cam};
use crate::{Evidence, report::drawing};

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

#[test]
fn labels_of_the_drawing_never_overlap() {
    let long =
        "a_very_long_name_of_a_place_that_nobody_would_type_twice_and_averyveryverylongwordwithoutbreaks";
    let models = socam_model::BUILTIN.iter().map(|(_, text)| (*text).to_owned()).chain([
        AALTO.to_owned(),
        AALTO
            .replace("\"sensor_upper_out\"", &format!("\"{long}\""))
            .replace("\"load_bearing\"", "\"load_bearing_of_the_brake\""),
        BRANCHES.to_owned(),
        WRIST.to_owned(),
    ]);
    for text in models {
        let model = Model::parse(&text).unwrap();
        let drawing = drawing::bench(&model, &[]).into_string();
        let document = roxmltree::Document::parse(&drawing).unwrap();
        let boxes: Vec<_> = document.descendants().filter_map(|node| text_box(&node)).collect();
        assert!(boxes.len() > model.nodes.len());
        for (index, (a, [left, top, right, bottom])) in boxes.iter().enumerate() {
            for (b, [other_left, other_top, other_right, other_bottom]) in &boxes[index + 1..] {
                let apart =
                    right <= other_left || other_right <= left || bottom <= other_top || other_bottom <= top;
                assert!(apart, "{}: {a} and {b}", model.name);
            }
        }
    }
}

/// A label and the room that it takes, with characters as wide as common fonts have them.
fn text_box(node: &roxmltree::Node<'_, '_>) -> Option<(String, [f64; 4])> {
    let label = node.has_tag_name("text") && node.attribute("x").is_some();
    let text = node.text().filter(|_| label)?;
    let number = |name| node.attribute(name).and_then(|value| value.parse::<f64>().ok());
    let (x, y, half) = (number("x")?, number("y")?, 0.5 * 6.8 * text.chars().count() as f64);
    Some((text.to_owned(), [x - half, y - 9.0, x + half, y + 2.5]))
}

/// Two windings and two differentials.
const WRIST: &str = include_str!("../../../../socam-model/tests/wrist.toml");

/// A branch at the hub, two shafts side by side, and a spring to the ground.
const BRANCHES: &str = include_str!("../../../../socam-model/tests/branches.toml");

#[test]
fn every_place_can_be_marked() {
    let places = [
        "motor",
        "coupling_1",
        "torque_sensor_in",
        "coupling_2",
        "cam_shaft",
        "cam_bearing",
        "mesh",
        "disk",
        "torque_sensor_out",
        "coupling_3",
        "load_shaft",
        "load_bearing",
        "load",
        "motor_speed",
        "output_speed",
        "torque_in",
        "torque_out",
    ];
    let marks =
        |name| drawing::bench(&speed_o_cam(), &[(name, drawing::PlaceMark::Finding(1))]).into_string();
    for place in places {
        let drawing = marks(place);
        assert_eq!(drawing.matches("class=\"mark\"").count(), 1, "{place}");
        assert_eq!(drawing.matches("class=\"diamond\"").count(), 1, "{place}");
    }
    assert_eq!(marks("nowhere").matches("class=\"mark").count(), 0);
}
