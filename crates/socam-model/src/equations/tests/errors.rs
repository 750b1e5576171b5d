//! Files and parameter values for which no equations exist.

use crate::Model;

#[test]
fn a_wrong_file_gets_line_key_and_what_was_expected() {
    let good = crate::BUILTIN[0].1;
    let cases: &[(&str, &str, &[&str])] = &[
        ("socam.model/1", "socam.model/9", &["line 3", "socam.model/1"]),
        (
            "unit = \"N m/deg\", bounds = [0.01, 100], source = \"catalogue, table 2.1\" }\nk2",
            "unit = \"furlong\" }\nk2",
            &["line 9", "k1.unit", "furlong", "N m/rad"],
        ),
        ("k1 = { value = 1.24, unit = \"N m/deg\"", "k1 = { value = 1.24", &["line 9", "unit"]),
        ("J2 = { value = 1.2875022e-4", "J2 = { value = -1.2875022e-4", &["line 28", "J2", "positive"]),
        ("stiffness = \"k1\"", "stiffness = \"k9\"", &["no parameter \"k9\""]),
        ("stiffness = \"k1\"", "stiffness = \"J2\"", &["J2", "N m/rad"]),
        ("to = \"cam_shaft\"", "to = \"crankshaft\"", &["no node \"crankshaft\"", "cam_shaft"]),
        ("name = \"coupling_2\"", "name = \"coupling_1\"", &["there already"]),
        ("damping = \"c5\"", "dampening = \"c5\"", &["dampening", "expected"]),
        ("role = \"input\"", "role = \"inlet\"", &["inlet", "input"]),
        (
            "c5 = { value = 0.05, unit = \"N m s/rad\", bounds = [1e-5, 5], source = \"assumed\" }",
            "c5 = \"soft\"",
            &["line 16", "value = 1.2"],
        ),
        ("bounds = [10, 1e4]", "bounds = [1e5, 10]", &["k3.bounds", "low < high"]),
        ("at = \"roller_pins\"", "at = \"mesh\"", &["torque_out", "mesh"]),
        ("[channels.motor_speed]\nrole = \"input\"\nquantity = \"speed\"\nat = \"motor\"", "", &[]),
        ("damping = \"c3\"", "", &[]),
    ];
    for (from, to, expected) in cases {
        assert!(good.contains(from), "{from} is not in the model file");
        match Model::parse(&good.replacen(from, to, 1)) {
            Ok(_) => assert!(expected.is_empty(), "{to} was accepted"),
            Err(error) => {
                let text = error.to_string();
                assert!(!expected.is_empty(), "{to} was refused: {text}");
                for word in *expected {
                    assert!(text.contains(word), "{to}: \"{text}\" lacks \"{word}\"");
                }
                assert_eq!(text.lines().count(), 1, "one sentence: {text}");
            }
        }
    }
}

#[test]
fn a_node_without_inertia_or_element_is_named() {
    let loose = crate::BUILTIN[1].1.replace("[[springs]]", "[[nodes]]\nname = \"adrift\"\n\n[[springs]]");
    let text = Model::parse(&loose).unwrap_err().to_string();
    assert!(text.contains("adrift"), "{text}");
}

#[test]
fn values_and_channels_that_cannot_be_are_refused() {
    let two_mass = crate::BUILTIN[1].1;
    let refused =
        |from: &str, to: &str| Model::parse(&two_mass.replacen(from, to, 1)).unwrap_err().to_string();
    // A torque input at a spring has no influence and is refused.
    let torque = "quantity = \"torque\"\nat = \"motor\"";
    assert!(two_mass.contains(torque));
    assert!(refused(torque, "quantity = \"torque\"\nat = \"shaft\"").contains("needs a node"));
    for scale in ["0", "nan", "inf"] {
        assert!(refused("role = \"input\"", &format!("role = \"input\"\nscale = {scale}")).contains("scale"));
    }
    let model = Model::builtin("speed-o-cam").unwrap();
    let mut values = model.values();
    values[model.parameter("N").unwrap()] = 0.0;
    assert!(model.equations(&values).unwrap_err().to_string().contains("parameter N"));
    let model = Model::builtin("emps").unwrap();
    let mut values = model.values();
    values[model.parameter("guide.transition_speed").unwrap()] = 0.0;
    assert!(model.equations(&values).unwrap_err().to_string().contains("transition_speed"));
}

#[test]
fn a_model_written_at_its_bounds_is_read_again() {
    for high in [4.5, 6.5, 9.0, 10.9, 12.9, 14.9] {
        let text = crate::BUILTIN[0].1.replace(
            "k4 = { value = 1.92, unit = \"N m/deg\", bounds = [0.01, 100]",
            &format!("k4 = {{ value = 0.1, unit = \"N m/deg\", bounds = [0.01, {high}]"),
        );
        let model = Model::parse(&text).unwrap();
        let k4 = &model.parameters[model.parameter("k4").unwrap()];
        for value in [k4.bounds.0, k4.bounds.1] {
            let update = crate::Update { name: "k4".into(), value, ci95: None, source: "test".into() };
            Model::parse(&model.text_with(&[update]).unwrap()).unwrap();
        }
    }
}
