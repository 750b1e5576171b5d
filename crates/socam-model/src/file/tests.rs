//! Units against quantities, wiring, and messages that say what to write.

use crate::{BUILTIN, Model};

const TWO_MASS: &str = BUILTIN[1].1;

/// The two-mass model's file with some text replaced.
fn changed(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(TWO_MASS.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in the model file");
        text.replacen(from, to, 1)
    })
}

fn refused(changes: &[(&str, &str)], words: &[&str]) {
    let text = changed(changes);
    let error = match Model::parse(&text) {
        Ok(_) => panic!("{changes:?} was accepted"),
        Err(error) => error.to_string(),
    };
    assert!(error.starts_with("line "), "no line: {error}");
    assert_eq!(error.lines().count(), 1, "one sentence: {error}");
    for word in words {
        assert!(error.contains(word), "{changes:?}: \"{error}\" lacks \"{word}\"");
    }
}

const TORQUE: &str = "role = \"input\"\nquantity = \"torque\"";

fn torque_input(lines: &str) -> String {
    format!("{TORQUE}\n{lines}")
}

#[test]
fn a_column_in_another_unit_needs_a_scale() {
    let with = |lines: &str| Model::parse(&changed(&[(TORQUE, &torque_input(lines))]));
    let no = |lines: &str, words: &[&str]| refused(&[(TORQUE, &torque_input(lines))], words);
    no(
        "column = \"motor_current_A\"",
        &["motor_torque", "motor_current_A", "in A", "torque is in N m", "scale = X, where one A is X N m"],
    );
    no("column = \"drive_V\"", &["in V", "scale"]);
    no("column = \"motor_speed_rad_s\"", &["in rad/s", "scale"]);
    no("column = \"oven_K\"", &["in K", "scale"]);
    no("column = \"duty_1\"", &["without a unit", "unit = ", "scale"]);
    assert_eq!(with("column = \"motor_current_A\"\nscale = 0.055").unwrap().channels[0].scale, 0.055);
    assert_eq!(with("column = \"m_Nm\"").unwrap().channels[0].scale, 1.0);
    // The unit of a column whose name has no suffix is known to the recording only.
    assert!(with("column = \"drive_torque\"").is_ok());
}

#[test]
fn a_column_of_bare_numbers_may_say_its_unit() {
    let speed = "role = \"output\"\nquantity = \"speed\"\nat = \"motor\"";
    let with = |lines: &str| Model::parse(&changed(&[(speed, &format!("{speed}\n{lines}"))]));
    let channel = |lines: &str| with(lines).unwrap().channels[1].clone();
    let rpm = channel("unit = \"rpm\"");
    assert_eq!(rpm.column, "motor_speed_1");
    assert!((rpm.scale * 60.0 - std::f64::consts::TAU).abs() < 1e-12, "{}", rpm.scale);
    let turned = channel("unit = \"rpm\"\ncolumn = \"tacho_1\"\nscale = -2");
    assert_eq!((turned.column.as_str(), turned.scale), ("tacho_1", -2.0 * rpm.scale));
    let no = |lines: &str, words: &[&str]| refused(&[(speed, &format!("{speed}\n{lines}"))], words);
    no("unit = \"deg\"", &["motor_speed.unit", "deg", "a speed is in rad/s"]);
    no("unit = \"rpn\"", &["motor_speed.unit", "rpn"]);
    no("unit = \"rpm\"\ncolumn = \"tacho_rad_s\"", &["_1", "tacho_rad_s", "rad/s"]);
    let encoder =
        "role = \"input\"\nquantity = \"speed\"\ncolumn = \"encoder_1\"\ntake = \"rate\"\nunit = \"deg\"";
    let text = changed(&[(TORQUE, encoder)]);
    let scale = Model::parse(&text).unwrap().channels[0].scale;
    assert!((scale * 180.0 - std::f64::consts::PI).abs() < 1e-12, "{scale}");
    refused(&[(TORQUE, &encoder.replace("deg", "rpm"))], &["rate of the column", "rad/s"]);
}

#[test]
fn other_spellings_of_units_are_read() {
    let plain = Model::parse(TWO_MASS).unwrap();
    let spelt = changed(&[
        ("\"kg m2\"", "\"kg m^2\""),
        ("\"N m/rad\"", "\"Nm/rad\""),
        ("\"N m s/rad\"", "\"N*m*s/rad\""),
    ]);
    assert_eq!(Model::parse(&spelt).unwrap().values(), plain.values());
}

#[test]
fn messages_say_what_to_write() {
    let number = [("stiffness = \"stiffness\"", "stiffness = 120")];
    refused(
        &number,
        &["line 26", "stiffness = \"k1\"", "[parameters]", "k1 = { value = 120, unit = \"N m/rad\" }"],
    );
    refused(
        &[("stiffness = \"stiffness\"", "stiffness = { value = 120 }")],
        &["line 26", "stiffness = \"k1\""],
    );
    refused(&[("damping = \"motor_damping\"", "damping = 0.1")], &["damping = \"c1\"", "N m s/rad"]);
    refused(&[("[[springs]]", "[springs]")], &["line 22", "[[springs]]", "two brackets"]);
    refused(&[("[channels.motor_torque]", "[[channels]]")], &["[channels.NAME]"]);
    let inertia = "motor_inertia = { value = 1.5e-3";
    refused(
        &[(inertia, "motor_inertia = { value = 0")],
        &["line 17", "motor_inertia", "is 0 kg m2", "positive", "no key inertia"],
    );
    refused(
        &[(inertia, "motor_inertia = { value = 20")],
        &["line 8", "motor_inertia.value is 20", "0.000001 to 10"],
    );
    refused(
        &[("damping = \"motor_damping\"", "damping = \"drag\"")],
        &["line 32", "drag", "unit = \"N m s/rad\""],
    );
}

#[test]
fn what_no_input_reaches_is_refused_with_its_line() {
    let pulley = "[[nodes]]\nname = \"pulley\"\ninertia = \"load_inertia\"\n\n[[springs]]";
    refused(&[("[[springs]]", pulley)], &["line 23", "nothing drives pulley", "join it"]);
    let sensor =
        "at = \"load\"\n[channels.pulley_speed]\nrole = \"output\"\nquantity = \"speed\"\nat = \"pulley\"";
    let text = changed(&[("[[springs]]", pulley)]);
    let error = Model::parse(&format!("{text}{}", &sensor[12..])).unwrap_err().to_string();
    assert!(error.contains("where channel pulley_speed measures"), "{error}");
    // A torque that an effect exerts on a node drives it without an input.
    let weight = "[[effects]]\neffect = \"constant_load\"\nat = \"pulley\"\nparameters = { torque = \"m\" }\n[[springs]]";
    let parameters = "[parameters]\nm = { value = 1, unit = \"N m\" }";
    let text = changed(&[("[[springs]]", pulley), ("[[springs]]", weight), ("[parameters]", parameters)]);
    Model::parse(&text).unwrap();
    let shaft = "[[shafts]]\nname = \"hub\"\nfrom = \"motor\"\nto = \"load\"\n[[springs]]";
    refused(&[("[[springs]]", shaft)], &["line 27", "shaft\" can never twist", "motor", "load"]);
    // An error of the network itself has a line too.
    refused(&[(TORQUE, "role = \"input\"\nquantity = \"acceleration\"")], &["line 38", "cannot drive"]);
}

#[test]
fn odd_models_are_warned_of_and_the_embedded_ones_are_not() {
    let published = [
        include_str!("../../../../tests/models/aalto.toml"),
        include_str!("../../../../tests/models/aalto-disc.toml"),
        include_str!("../../../../tests/models/aalto-mesh.toml"),
        include_str!("../../../../tests/models/coupling-bench.toml"),
        include_str!("../../../../tests/models/coupling-testbed.toml"),
    ];
    for text in BUILTIN.iter().map(|(_, text)| *text).chain(published) {
        assert_eq!(Model::parse(text).unwrap().warnings(), Vec::<String>::new());
    }
    let warned = |text: &str, words: &[&str]| {
        let warnings = Model::parse(text).unwrap().warnings();
        let [warning] = &warnings[..] else { panic!("{warnings:?}") };
        assert!(words.iter().all(|word| warning.contains(word)), "{warning}");
    };
    warned(
        &changed(&[("[parameters]", "[parameters]\nbelt_damping = { value = 1, unit = \"N m s/rad\" }")]),
        &["belt_damping", "remove"],
    );
    let ratio = "[parameters]\nN = { value = 3, unit = \"1\" }";
    // The belt runs to the motor, not to the pulley on the motor's gear.
    let gear = "[[nodes]]\nname = \"pulley\"\n[[gears]]\nname = \"mesh\"\nfrom = \"motor\"\nto = \"pulley\"\nratio = \"N\"\n[[springs]]";
    let belt = changed(&[("[parameters]", ratio), ("[[springs]]", gear)]);
    warned(&belt, &["mesh moves nothing", "pulley"]);
    Model::parse(&belt.replacen("from = \"motor\"\nto = \"load\"", "from = \"pulley\"\nto = \"load\"", 1))
        .map(|m| assert!(m.warnings().is_empty()))
        .unwrap();
    let second = "[[springs]]\nname = \"belt\"\nfrom = \"pulley\"\nto = \"load\"\nstiffness = \"stiffness\"\n[[springs]]";
    let locked = changed(&[("[parameters]", ratio), ("[[springs]]", gear), ("[[springs]]", second)]);
    warned(&locked, &["nothing can turn", "3 times", "wrong side of a gear"]);
    let end = "[[nodes]]\nname = \"tip\"\n[[springs]]\nname = \"whip\"\nfrom = \"load\"\nto = \"tip\"\nstiffness = \"stiffness\"\n[[springs]]";
    warned(&changed(&[("[[springs]]", end)]), &["whip carries no torque", "tip"]);
    let speed =
        "[channels.tacho]\nrole = \"input\"\nquantity = \"speed\"\nat = \"load\"\n[channels.motor_torque]";
    warned(&changed(&[("[channels.motor_torque]", speed)]), &["load_speed contains no information", "tacho"]);
    let speed = speed.replace("load", "motor");
    let both = Model::parse(&changed(&[("[channels.motor_torque]", &speed)])).unwrap().warnings();
    assert!(both[0].contains("channel motor_torque moves nothing"), "{both:?}");
}

#[test]
fn a_model_beyond_the_limits_is_refused_in_words() {
    let text = crate::BUILTIN[0].1;
    let nodes: String = (0..1000).map(|node| format!("[[nodes]]\nname = \"n{node}\"\n")).collect();
    let parameters: String = (0..60_000).map(|p| format!("x{p} = {{ value = 1, unit = \"1\" }}\n")).collect();
    for (text, said) in [
        (format!("{text}\n{nodes}"), "at most 100 [[nodes]]"),
        (text.replacen("[parameters]\n", &format!("[parameters]\n{parameters}"), 1), "more than 300 names"),
        (text.replacen("value = 1.24", "value = 1e308", 1), "k1.value is beyond 1e30"),
        (text.replacen("value = 1.24", "value = -1e-320", 1), "k1.value is nearer to 0 than 1e-60"),
    ] {
        let problem = Model::parse(&text).unwrap_err().to_string();
        assert!(problem.contains(said), "{problem}");
    }
}
