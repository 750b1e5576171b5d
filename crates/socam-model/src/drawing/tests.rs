use super::*;

const AALTO: &str = include_str!("../../../../tests/models/aalto.toml");
const LONG: &str =
    "a_very_long_name_of_a_place_that_nobody_would_type_twice_and_averyveryverylongwordwithoutbreaks";

/// Embedded models, a wrist with windings and differentials, branches, long names, and a gear with play.
fn models() -> Vec<Model> {
    let long = AALTO
        .replace("\"sensor_upper_out\"", &format!("\"{LONG}\""))
        .replace("\"load_bearing\"", "\"load_bearing_of_the_brake\"");
    let texts = crate::BUILTIN.iter().map(|(_, text)| *text).chain([
        include_str!("../../tests/branches.toml"),
        include_str!("../../tests/wrist.toml"),
        AALTO,
        &long,
    ]);
    let mut models: Vec<Model> = texts.map(|text| Model::parse(text).unwrap()).collect();
    let bench = Model::builtin("speed-o-cam").unwrap();
    let play = bench.with_effect("backlash", "mesh", &[("gap", 0.001)]).unwrap();
    models.push(play.with_effect("coulomb_friction", "load_bearing", &[("torque", 0.1)]).unwrap());
    models
}

type Area = [Point; 2];

fn apart([from, to]: Area, [other_from, other_to]: Area) -> bool {
    to[0] <= other_from[0] || other_to[0] <= from[0] || to[1] <= other_from[1] || other_to[1] <= from[1]
}

/// The room that a text takes, with letters as wide as common fonts have them.
fn text_area(item: &Item) -> Option<(String, Area)> {
    let Shape::Text { at: [x, y], text } = &item.shape else { return None };
    let size = item.paint.text_size();
    let half = 0.5 * grid::LETTER_WIDTH / 11.0 * size * text.chars().count() as f64;
    Some((text.clone(), [[x - half, y - 0.8 * size], [x + half, y + 0.22 * size]]))
}

fn diamond_area(item: &Item) -> Option<Area> {
    let Shape::Polygon(corners) = &item.shape else { return None };
    (item.paint == Paint::Diamond).then(|| [[corners[3][0], corners[0][1]], [corners[1][0], corners[2][1]]])
}

const STYLES: [Style; 3] = [
    Style { columns: 13, column_width: 88.0 },
    Style { columns: 13, column_width: 64.0 },
    Style { columns: 4, column_width: 76.0 },
];

#[test]
fn no_text_lies_on_another_or_outside() {
    for (model, style) in models().iter().flat_map(|model| STYLES.map(|style| (model, style))) {
        let drawing = Drawing::of(model, &[], style);
        let texts: Vec<_> = drawing.items.iter().filter_map(text_area).collect();
        assert!(texts.len() > model.nodes.len());
        for (index, (text, area)) in texts.iter().enumerate() {
            for (other, other_area) in &texts[index + 1..] {
                assert!(apart(*area, *other_area), "{}, {style:?}: {text} and {other}", model.name);
            }
            let [[left, top], [right, bottom]] = *area;
            let inside = left >= 0.0 && top >= 0.0 && right <= drawing.size[0] && bottom <= drawing.size[1];
            assert!(inside, "{}, {style:?}: {text} is outside", model.name);
        }
    }
}

/// Findings at every place at once: more than any diagnosis has.
#[test]
fn no_diamond_lies_on_a_name_or_on_another_diamond() {
    for (model, style) in models().iter().flat_map(|model| STYLES.map(|style| (model, style))) {
        let places = Drawing::of(model, &[], style).places;
        let marks: Vec<(&str, PlaceMark)> =
            places.iter().map(|place| (place.name.as_str(), PlaceMark::Finding(1))).collect();
        let drawing = Drawing::of(model, &marks, style);
        let names = drawing.items.iter().filter(|item| item.paint != Paint::Number);
        let names: Vec<_> = names.filter_map(text_area).collect();
        let diamonds: Vec<_> = drawing.items.iter().filter_map(diamond_area).collect();
        assert_eq!(diamonds.len(), places.len());
        for (index, diamond) in diamonds.iter().enumerate() {
            for (name, area) in &names {
                assert!(apart(*diamond, *area), "{}, {style:?}: a diamond on {name}", model.name);
            }
            for (other, name) in diamonds.iter().zip(&places).skip(index + 1) {
                let own = &places[index];
                assert!(apart(*diamond, *other), "{}, {style:?}: {own:?} and {name:?}", model.name);
            }
        }
    }
}

#[test]
fn every_place_of_the_default_bench_can_be_marked() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let count = |marks: &[(&str, PlaceMark)], paint| {
        let drawing = Drawing::of(&model, marks, Style::default());
        drawing.items.iter().filter(|item| item.paint == paint).count()
    };
    for place in Drawing::of(&model, &[], Style::default()).places {
        let mark = [(place.name.as_str(), PlaceMark::Finding(3)), (place.name.as_str(), PlaceMark::Rival)];
        let counts = [Paint::Finding, Paint::Diamond, Paint::Rival].map(|paint| count(&mark, paint));
        assert_eq!(counts, [1, 1, 0], "{}", place.name);
        assert_eq!(count(&mark[1..], Paint::Rival), 1, "{}", place.name);
    }
    assert_eq!(count(&[("nowhere", PlaceMark::Finding(1))], Paint::Finding), 0);
}

#[test]
fn the_contact_of_a_gear_with_play_is_not_drawn() {
    let bench = Model::builtin("speed-o-cam").unwrap();
    let play = bench.with_effect("backlash", "mesh", &[("gap", 0.001)]).unwrap();
    let names = |model: &Model| -> Vec<String> {
        Drawing::of(model, &[], Style::default()).places.into_iter().map(|place| place.name).collect()
    };
    assert!(play.nodes.len() > bench.nodes.len(), "a node stands for the teeth");
    assert_eq!(names(&play), names(&bench));
}
