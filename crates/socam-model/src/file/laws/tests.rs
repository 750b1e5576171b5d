//! Laws of model files: their equations, what they need of a file, and what is refused.

use crate::{
    BUILTIN, Model, Quantity, Site,
    effects::{self, LawInput},
    equations::tests::assert_derivatives_are_differences,
};

const TWO_MASS: &str = BUILTIN[1].1;

/// The two-mass model's file with parameters, laws and channels.
fn text(parameters: &str, laws: &str, channels: &str) -> String {
    let text = TWO_MASS.replacen("[parameters]\n", &format!("[parameters]\n{parameters}\n"), 1);
    format!("{text}\n{laws}\n{channels}\n")
}

const BRAKE: &str = "friction = { value = 0.3, unit = \"N m\", bounds = [0, 5] }\nwidth = { value = 5, unit = \"rpm\" }\nshare = { value = 0.1, unit = \"1\" }";
const LOAD: &str = "[channels.load_torque]\nrole = \"input\"\nquantity = \"torque\"\nat = \"load\"";

fn law(at: &str, formula: &str, more: &str) -> String {
    format!("[[laws]]\nname = \"brake\"\nat = \"{at}\"\nformula = \"{formula}\"\n{more}\n")
}

fn error(parameters: &str, laws: &str, channels: &str) -> String {
    match Model::parse(&text(parameters, laws, channels)) {
        Ok(_) => panic!("accepted: {laws}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_formula_equal_to_coulomb_friction_gives_the_same_equations() {
    let own = law("load_bearing", "-a*tanh(speed/b)", "parameters = { a = \"friction\", b = \"width\" }");
    let own = Model::parse(&text(BRAKE, &own, "")).unwrap();
    assert!(own.warnings()[0].contains("share"), "{:?}", own.warnings());
    let of_catalogue = "[[effects]]\neffect = \"coulomb_friction\"\nat = \"load_bearing\"\nparameters = { torque = \"friction\", transition_speed = \"width\" }";
    let of_catalogue = Model::parse(&text(BRAKE, of_catalogue, "")).unwrap();
    let [a, b] = [&own, &of_catalogue].map(|model| model.equations(&model.values()).unwrap());
    assert_eq!((&a.force, &a.port, &a.state), (&b.force, &b.port, &b.state));
    let values = own.values();
    for speed in [-3.0, -0.1, 0.0, 0.02, 0.6, 40.0] {
        let [found, expected] = [&a.ports[0], &b.ports[0]].map(|port| {
            let parameters = port.values(&values);
            assert!((port.law.transition_at(&parameters) / parameters[1] - 1.0).abs() < 1e-12);
            port.evaluate(&[speed], &parameters)
        });
        assert!((found.torque - expected.torque).abs() < 1e-14);
        assert!((found.derivatives[0] - expected.derivatives[0]).abs() < 1e-12);
        for (found, expected) in found.by_parameter.iter().zip(expected.by_parameter) {
            assert!((found - expected).abs() < 1e-12, "{speed}: {found}, {expected}");
        }
    }
    let friction = own.parameter("friction").unwrap();
    let without: Vec<f64> = values
        .iter()
        .enumerate()
        .map(|(index, value)| if index == friction { 0.0 } else { *value })
        .collect();
    assert!(a.ports[0].is_inactive(&without) && !a.ports[0].is_inactive(&values));
    // A width keeps the sign that it has in the file.
    assert_eq!(own.parameters[own.parameter("width").unwrap()].bounds.0, 0.0);
}

#[test]
fn laws_read_places_and_channels() {
    let channels = format!(
        "{LOAD}\n[channels.oil]\nrole = \"input\"\nquantity = \"signal\"\nat = \"load\"\ncolumn = \"oil_K\""
    );
    let parameters = format!(
        "{BRAKE}\nthin = {{ value = 1e-3, unit = \"N m s/K\" }}\nharden = {{ value = 2, unit = \"N m\" }}"
    );
    let laws = [
        law("load_bearing", "-friction*tanh(speed/width) - share*load_torque", ""),
        law(
            "load",
            "-thin*(oil - 300*warm)*speed*tanh(load_speed/width)",
            "inputs = { oil = \"oil\" }\nparameters = { warm = \"one\" }",
        ),
        law("shaft", "harden*twist^3 + 0.01*torque", ""),
        law("load_speed", "0.01*reading*sin(2*angle)", ""),
    ];
    let parameters = format!("{parameters}\none = {{ value = 1, unit = \"K\" }}");
    let laws: String = laws
        .iter()
        .zip(["one", "two", "three", "four"])
        .map(|(law, name)| law.replacen("brake", name, 1))
        .collect();
    let model = Model::parse(&text(&parameters, &laws, &channels)).unwrap();
    assert_eq!(model.warnings(), Vec::<String>::new());
    assert_derivatives_are_differences(&model, 1e-5);
    let symbols = |index: usize| -> Vec<&str> {
        model.effects[index].effect.laws()[0].law_inputs.iter().map(|input| input.symbol()).collect()
    };
    assert_eq!(symbols(0), ["speed", "load_torque"]);
    assert_eq!(symbols(1), ["speed", "oil", "load_speed"]);
    assert_eq!((symbols(2), symbols(3)), (vec!["twist", "through"], vec!["reading", "angle"]));
    assert_eq!(model.effects[2].effect.laws()[0].formula, "harden*twist^3 + 0.01*through");
    assert!(matches!(model.effects[3].at, Site::Channel(_)));
    let oil = model.channels.iter().find(|channel| channel.name == "oil").unwrap();
    assert_eq!((oil.unit, oil.quantity, oil.quantity.is_exact()), ("K", Quantity::Signal, true));
    // The second port of the first law is the load torque and nothing else.
    let equations = model.equations(&model.values()).unwrap();
    let load = model.inputs().position(|input| input.name == "load_torque").unwrap();
    assert_eq!((equations.port_input[(1, load)], equations.port.row(1).amax()), (1.0, 0.0));
    assert!(matches!(equations.ports[1].law.law_inputs[1], LawInput::Channel { channel: "load_torque", .. }));
}

#[test]
fn a_law_at_a_gear_acts_on_its_slow_side() {
    let cam = Model::builtin("speed-o-cam").unwrap();
    let gear = cam.gears[0].name.clone();
    let own = format!(
        "[[laws]]\nname = \"mesh\"\nat = \"{gear}\"\nformula = \"-eta*abs(torque)*tanh(speed/slow)\"\n"
    );
    let parameters =
        "[parameters]\neta = { value = 0.1, unit = \"%\" }\nslow = { value = 1, unit = \"rpm\" }";
    let text = format!("{}\n{own}", cam.text.replacen("[parameters]", parameters, 1));
    let model = Model::parse(&text).unwrap();
    assert_derivatives_are_differences(&model, 1e-4);
    assert!(matches!(model.effects[0].at, Site::Gear { .. }));
}

#[test]
fn a_candidate_is_no_part_of_the_model_until_an_effect_names_it() {
    let own = law(
        "load_bearing",
        "-a*tanh(speed/width) - c*load_torque",
        "parameters = { a = \"friction\", c = \"share\" }\ncandidate = true",
    );
    let model = Model::parse(&text(BRAKE, &own, LOAD)).unwrap();
    assert!(model.effects.is_empty() && model.warnings().is_empty(), "{:?}", model.warnings());
    let fixed = |name: &str| model.parameters[model.parameter(name).unwrap()].fixed;
    assert!(fixed("friction") && fixed("width") && fixed("share") && !fixed("stiffness"));
    let effect = model.candidates[0].effect;
    assert_eq!(effect.amplitude.parameters, ["a", "c"]);
    assert_eq!(effect.places_in(&model), ["load_bearing"]);
    let grown =
        model.with_effect("brake", "load_bearing", &[("a", 0.2), ("width", 0.05), ("c", 0.1)]).unwrap();
    assert!(std::ptr::eq(grown.effects[0].effect, effect));
    let width = &grown.parameters[grown.parameter("load_bearing_brake_width").unwrap()];
    assert_eq!((width.value, width.fixed, width.unit.as_str()), (0.05, false, "rad/s"));
    assert!(model.with_effect("brake", "motor_bearing", &[("a", 0.2), ("width", 0.05), ("c", 0.1)]).is_err());
    // Bounds of the candidate's parameters are those of the effect's.
    assert!(model.with_effect("brake", "load_bearing", &[("a", 6.0), ("width", 0.05), ("c", 0.1)]).is_err());
    // Its formula is read once for both.
    assert!(std::ptr::eq(Model::parse(&model.text).unwrap().candidates[0].effect, effect));
    assert!(effects::find("brake").is_none());
}

#[test]
fn what_is_no_law_is_explained() {
    let brake = |formula: &str| error(BRAKE, &law("load_bearing", formula, ""), LOAD);
    for (formula, words) in [
        (
            "-friction*speed",
            "laws.brake.formula is in \"N m/s\", but at load_bearing it gives a torque in \"N m\"",
        ),
        ("-friction*tanh(speed)", "character 11: tanh needs a number without unit"),
        ("-friction + speed", "character 11: + joins \"N m\" and \"rad/s\""),
        ("-frction", "there is no frction at a bearing (is `friction` meant?)"),
        ("-friction*twist", "there is no twist at a bearing"),
        ("-friction*sign(speed)", "character 11: sign jumps where its argument is 0"),
        ("friction*speed^", "character 16: the formula ends"),
        ("friction*log(0*speed)", "no finite value"),
        ("speed", "a factor in \"N m s/rad\" is missing"),
    ] {
        let found = brake(formula);
        assert!(found.contains(words), "{formula}: {found}");
        assert!(found.starts_with("line ") && found.lines().count() == 1, "{found}");
    }
    let long = brake(&format!("friction{}", "*1".repeat(600)));
    assert!(long.contains("more than 1000 characters"), "{long}");
    let many = brake(&format!("friction{}", "*1".repeat(200)));
    assert!(many.contains("at most 120 are read"), "{many}");
    let typo = law(
        "load_bearing",
        "-friction*tanh(lod/t)",
        "inputs = { load = \"load_torque\" }\nparameters = { t = \"friction\" }",
    );
    assert!(error(BRAKE, &typo, LOAD).contains("there is no lod at a bearing (is `load` meant?)"));
    let with = |more: &str| error(BRAKE, &law("load_bearing", "-friction*tanh(speed/width)", more), LOAD);
    assert!(with("inputs = { load = \"load_torque\" }").contains("does not name load"));
    assert!(with("parameters = { speed = \"width\" }").contains("speed has a meaning"));
    assert!(with("parameters = { friction = \"frction\" }").contains("(is `friction` meant?)"));
    assert!(with("parameters = { friction = 0.1 }").contains("must be the name of a parameter"));
    let twice = law("load_bearing", "-friction*tanh(speed/width)", "");
    assert!(error(BRAKE, &format!("{twice}{twice}"), LOAD).contains("names must differ"));
    assert!(error(BRAKE, &twice.replace("brake", "backlash"), LOAD).contains("effect of the catalogue"));
    assert!(
        error(BRAKE, &twice.replace("load_bearing", "attic"), LOAD)
            .contains("acts at a bearing, spring, gear, node or channel")
    );
    let bent = law("load_bearing", "friction*(1 - exp(-abs(speed/width)^share))", "candidate = true");
    assert!(Model::parse(&text(BRAKE, &bent, "")).is_ok());
    let bent = law("load_bearing", "-(friction^2)^0.5*tanh(speed/width)", "candidate = true");
    assert!(error(BRAKE, &bent, "").contains("a candidate needs parameters in which its formula is linear"));
    let names: Vec<String> = (0..=effects::MAX_PARAMETERS).map(|index| format!("p{index}")).collect();
    let parameters: String =
        names.iter().map(|name| format!("{name} = {{ value = 1, unit = \"N m\" }}\n")).collect();
    assert!(
        error(&parameters, &law("load_bearing", &names.join("+"), ""), "")
            .contains(&format!("{} parameters", names.len()))
    );
    let zero = BRAKE.replace("value = 5", "value = 0");
    assert!(error(&zero, &twice, LOAD).contains("divides by width, which is 0"));
}

#[test]
fn a_curve_is_a_law_with_its_own_factor() {
    let curve = |more: &str, values: &str| {
        let more = format!("curve = {{ over = \"load_torque\", at = [-1, 0, 2], values = {values}{more} }}");
        law("load_bearing", "-curve*tanh(speed/width)", &more)
    };
    let named = curve("", "[\"friction\", \"low\", \"friction\"]");
    let parameters = format!("{BRAKE}\nlow = {{ value = 40, unit = \"mN m\" }}");
    let named = Model::parse(&text(&parameters, &named, LOAD)).unwrap();
    let effect = named.effects[0].effect;
    assert_eq!(
        effect.parameters.iter().map(|own| own.name).collect::<Vec<_>>(),
        ["width", "value_1", "value_2", "value_3"]
    );
    let fixed = curve(", unit = \"mN m\"", "[300, 40, 300]");
    let fixed = Model::parse(&text(&parameters, &fixed, LOAD)).unwrap();
    for inputs in [[1.0, -0.4], [0.1, 1.7], [-2.0, 4.0]] {
        let [a, b] = [&named, &fixed].map(|model| {
            let port = model.equations(&model.values()).unwrap().ports.remove(0);
            port.evaluate(&inputs, &port.values(&model.values()))
        });
        assert!((a.torque - b.torque).abs() < 1e-15 && (a.derivatives[1] - b.derivatives[1]).abs() < 1e-15);
    }
    let refused = |more: &str, values: &str| error(&parameters, &curve(more, values), LOAD);
    assert!(refused("", "[1, 2, 3]").contains("needs the unit of its values"));
    assert!(refused(", unit = \"N m\"", "[1, 2]").contains("3 positions in `at` and 2 values"));
    assert!(
        refused(", unit = \"N\"", "[1, 2, 3]")
            .contains("is in \"N\", but at load_bearing it gives a torque in \"N m\"")
    );
    assert!(
        refused(", unit = \"N m\", at_unit = \"rpm\"", "[1, 2, 3]")
            .contains("at_unit is \"rpm\", but load_torque is in \"N m\"")
    );
    assert!(refused("", "[\"friction\", \"width\", \"low\"]").contains("are in \"N m\" and \"rpm\""));
}

#[test]
fn a_law_that_pushes_its_bearing_along_is_told() {
    let warnings = |formula: &str, more: &str| {
        let model = Model::parse(&text(BRAKE, &law("load_bearing", formula, more), LOAD)).unwrap();
        let all = model.warnings().into_iter();
        all.filter(|sentence| sentence.contains("pushes its bearing")).collect::<Vec<_>>()
    };
    for more in ["", "candidate = true"] {
        let told = warnings("(friction + share*load_torque)*tanh(speed/width)", more);
        assert_eq!(told.len(), 1);
        assert!(
            told[0].starts_with(
                "the law brake pushes its bearing along at every speed, with 0.287 N m at 1 rad/s"
            ),
            "{told:?}"
        );
    }
    for right in [
        "-friction*tanh(speed/width)",
        "friction*speed/width*(1 - abs(speed/width))",
        "friction + share*load_torque",
    ] {
        assert!(warnings(right, "").is_empty(), "{right}");
    }
}
