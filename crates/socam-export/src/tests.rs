//! Every effect at every place in every target, and names that try to break out.

use std::collections::HashSet;

use socam_model::{
    Model,
    effects::{CATALOGUE, Form},
};

use crate::{
    Exported, Provenance, Target,
    description::Description,
    export,
    formula::Formula,
    program::{Line, Program},
};

fn exported(model: &Model, target: Target) -> Exported {
    let provenance = Provenance::new("model.toml", &model.text);
    export(model, &provenance, target, "bench").unwrap_or_else(|error| panic!("{}: {error}", target.name()))
}

/// Embedded models, each with one effect at one of its places, and the words that name it.
fn with_each_effect() -> Vec<(Model, String)> {
    let mut found = Vec::new();
    for name in ["speed-o-cam", "two-mass", "emps-loop"] {
        let model = Model::builtin(name).unwrap();
        // A mounting is refused, see below.
        for effect in CATALOGUE.iter().filter(|effect| !matches!(effect.form, Form::Mounting)) {
            for place in model.places(effect) {
                let values: Vec<_> = effect.given().map(|own| (own.name, 0.1)).collect();
                if let Ok(grown) = model.with_effect(effect.id, place, &values) {
                    found.push((grown, format!("{} at {place}", effect.id)));
                }
            }
        }
    }
    assert!(found.len() > 100, "{}", found.len());
    found.extend(laws_of_a_file());
    found
}

/// The two-mass model with laws of its own: a formula of a place, a parameter, an input and an output, and a curve over time.
fn laws_of_a_file() -> Vec<(Model, String)> {
    let text = socam_model::BUILTIN[1].1.replacen(
        "[parameters]",
        "[parameters]\na = { value = 0.3, unit = \"N m\" }\nb = { value = 5, unit = \"rpm\" }\nc = { value = 0.1, unit = \"1\" }",
        1,
    );
    let formula = "name = \"brake\"\nat = \"load_bearing\"\nformula = \"-a*tanh(speed/b)*cos(0.1*atan(motor_speed/b)) - c*motor_torque\"";
    let curve = "name = \"ageing\"\nat = \"motor_bearing\"\nformula = \"-curve*tanh(speed/b)\"\ncurve = { over = \"time\", at = [0, 1, 9], values = [\"a\", \"a\", \"a\"] }";
    let with = |law: &str, what: &str| {
        (Model::parse(&format!("{text}\n[[laws]]\n{law}\n")).unwrap(), what.to_owned())
    };
    vec![with(formula, "brake at load_bearing"), with(curve, "ageing at motor_bearing")]
}

#[test]
fn every_name_of_the_equations_is_defined_before_it_is_used() {
    for (model, what) in with_each_effect() {
        let provenance = Provenance::new("model.toml", &model.text);
        let mut d = Description::of(&model, &provenance, "bench");
        let program = Program::of(&mut d).unwrap();
        let parameters = d.parameters.iter().map(|own| own.identifier.as_str());
        let states = program.states.iter().map(|own| own.name.as_str());
        let unknowns = program.unknowns.iter().map(|own| own.name.as_str());
        let changes = program.changes.iter().map(|(_, name)| name.as_str());
        let inputs = d.inputs.iter().map(|signal| signal.identifier.as_str()).chain(changes);
        let all = parameters.chain(states).chain(unknowns).chain(inputs).chain(["t", "pi"]);
        let mut known: HashSet<&str> = all.collect();
        let check = |formula: &Formula, known: &HashSet<&str>| {
            assert!(!formula.names(&|name| !known.contains(name)), "{what}: {formula:?}");
        };
        for line in &program.lines {
            if let Line::Assignment(own) = line {
                check(&own.formula, &known);
                assert!(known.insert(&own.name), "{what}: {} is assigned twice", own.name);
            }
        }
        program.states.iter().for_each(|own| check(&own.rate, &known));
        program.unknowns.iter().for_each(|own| check(&own.balance, &known));
        program.outputs.iter().for_each(|own| check(&own.reading, &known));
    }
}

/// Effects that change the values or the network of bodies, which every target holds without a word.
const HELD: [&str; 9] = [
    "missing_inertia",
    "missing_compliance",
    "sensor_gain",
    "quadratic_drag",
    "constant_load",
    "stiffness_hardening",
    "gravity_unbalance",
    "coulomb_friction",
    "sensor_offset",
];

#[test]
fn no_effect_is_dropped_without_a_word() {
    for (model, what) in with_each_effect() {
        for target in [Target::Mujoco, Target::Urdf, Target::Sdf] {
            let exported = exported(&model, target);
            let said = exported.left_out.iter().any(|part| part.what == what);
            let held = HELD.iter().any(|id| what.starts_with(id));
            assert!(said || held, "{} drops {what}", target.name());
            // Each part that is listed as left out is named in the file too.
            assert!(!said || exported.text.contains(&format!("{what}: ")), "{what}");
            roxmltree::Document::parse(&exported.text).unwrap_or_else(|error| panic!("{what}: {error}"));
        }
        let modelica = exported(&model, Target::Modelica).text;
        assert!(modelica.contains("end bench;"), "{what}");
    }
}

#[test]
fn a_mounting_that_gives_way_is_refused_by_its_place() {
    let model = Model::builtin("two-mass").unwrap();
    let mounting = CATALOGUE.iter().find(|effect| matches!(effect.form, Form::Mounting)).unwrap();
    let values: Vec<_> = mounting.given().map(|own| (own.name, 0.1)).collect();
    let mounted = model.with_effect(mounting.id, "motor", &values).unwrap();
    for target in Target::ALL {
        let refused = export(&mounted, &Provenance::new("model.toml", &mounted.text), target, "bench");
        let said = refused.map(|_| ()).unwrap_err().to_string();
        assert!(said.contains("the mounting of `motor` that gives way"), "{said}");
    }
}

#[test]
fn hostile_names_stay_names() {
    let text = socam_model::BUILTIN[1].1;
    let evil = r#""]--> \u0007 */ end; exit() 'x' % \\ é""#;
    let text = text.replace("name = \"two-mass\"", &format!("name = {evil}"));
    let text = text.replace("\"example\"", evil).replace("motor_inertia", "lambda");
    let text = text.replace("name = \"shaft\"", &format!("name = {evil}"));
    let model = Model::parse(&text).unwrap();
    for target in Target::ALL {
        let exported = exported(&model, target);
        let is_plain = |c: char| !c.is_control() || c == '\n';
        assert!(exported.text.chars().all(is_plain), "{}", target.name());
        if matches!(target, Target::Mujoco | Target::Urdf | Target::Sdf) {
            roxmltree::Document::parse(&exported.text).unwrap();
        } else {
            // Names of unknown origin occur in comments and strings only.
            let mark = match target {
                Target::Python => "#",
                Target::Modelica => "//",
                _ => "%",
            };
            for line in exported.text.lines().filter(|line| line.contains("exit()")) {
                let code = line.split(mark).next().unwrap_or_default();
                let quoted = code.split("exit()").next().unwrap_or_default();
                let open = quoted.replace("\\\"", "").replace("''", "").matches(['"', '\'']).count();
                assert!(!code.contains("exit()") || open % 2 == 1, "{}: {line}", target.name());
            }
        }
    }
}

#[test]
fn every_link_of_an_sdf_hangs_on_one_joint() {
    for name in ["speed-o-cam", "two-mass", "emps"] {
        let text = exported(&Model::builtin(name).unwrap(), Target::Sdf).text;
        let document = roxmltree::Document::parse(&text).unwrap();
        let named = |tag: &str| -> Vec<String> {
            let all = document.descendants().filter(|node| node.has_tag_name(tag));
            all.filter_map(|node| node.attribute("name").or(node.text()).map(str::to_owned)).collect()
        };
        let (mut links, mut children) = (named("link"), named("child"));
        links.sort();
        children.sort();
        assert_eq!(links, children, "{name}");
        assert!(named("parent").iter().all(|parent| parent == "world" || links.contains(parent)), "{name}");
        assert!(named("parent").contains(&"world".to_owned()), "{name}");
    }
}

#[test]
fn a_gear_and_massless_nodes_are_condensed_for_mujoco() {
    let exported = exported(&Model::builtin("speed-o-cam").unwrap(), Target::Mujoco);
    let document = roxmltree::Document::parse(&exported.text).unwrap();
    // The roller pins and coupling 3 are one spring, seen from the cam shaft at an eighth.
    let pins = document.descendants().find(|node| node.attribute("name") == Some("roller_pins_coupling_3"));
    let stiffness: f64 = pins.unwrap().attribute("stiffness").unwrap().parse().unwrap();
    let (k3, k4) = (52_482.934_034, 110.007_896_665);
    assert!((stiffness / (k3 * k4 / (k3 + k4)) - 1.0).abs() < 1e-9, "{stiffness}");
    let coefficient = pins.unwrap().descendants().find(|node| node.attribute("joint") == Some("q_cam_shaft"));
    assert_eq!(coefficient.unwrap().attribute("coef"), Some("0.125"));
    assert!(exported.left_out.iter().any(|part| part.what == "massless node torque_sensor_out"));
}

#[test]
fn names_of_one_kind_differ() {
    let text = socam_model::BUILTIN[1].1;
    let text = text.replace("name = \"shaft\"", "name = \"node_motor\"").replace("\"load\"", "\"q_motor\"");
    let model = Model::parse(&text).unwrap();
    for target in [Target::Mujoco, Target::Urdf, Target::Sdf] {
        let text = exported(&model, target).text;
        let document = roxmltree::Document::parse(&text).unwrap();
        let mut known = HashSet::new();
        let parts =
            document.descendants().filter(|node| node.has_tag_name("joint") || node.has_tag_name("link"));
        let parts = parts.chain(document.descendants().filter(|node| node.has_tag_name("fixed")));
        for name in parts.filter(|node| !node.ancestors().any(|own| own.has_tag_name("transmission"))) {
            let Some(name) = name.attribute("name") else { continue };
            assert!(known.insert(name), "{}: {name}", target.name());
        }
        assert!(known.len() >= 4, "{known:?}");
    }
}
