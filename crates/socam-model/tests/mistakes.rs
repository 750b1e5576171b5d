//! Typical mistakes in a model file, each with its message. docs/model-mistakes.md shows the same table.

use socam_model::{BUILTIN, Model};

const DOCUMENT: &str = include_str!("../../../docs/model-mistakes.md");

/// What is wrong, the text that is replaced in the file of `two-mass`, what is written instead, and the message.
const MISTAKES: &[[&str; 4]] = &[
    [
        "schema is missing",
        "schema = \"socam.model/1\"\n",
        "",
        "line 1: schema is missing; write schema = \"socam.model/1\"",
    ],
    [
        "schema of another version",
        "socam.model/1",
        "socam.model/2",
        "line 2: schema is \"socam.model/2\", but this version reads \"socam.model/1\"; write schema = \"socam.model/1\"",
    ],
    [
        "`motion` is no motion",
        "motion = \"rotation\"",
        "motion = \"rotary\"",
        "line 5: there is no `rotary` here (is `rotation` meant?), expected `rotation` or `translation`",
    ],
    [
        "misspelt key",
        "stiffness = \"stiffness\"",
        "stiffnes = \"stiffness\"",
        "line 26: there is no key `stiffnes` here (is `stiffness` meant?), expected one of `name`, `from`, `to`, `stiffness`, `damping`",
    ],
    [
        "one bracket instead of two",
        "[[springs]]",
        "[springs]",
        "line 22: [springs] is one table, but a model has a list of springs; write [[springs]], with two brackets, above each of them",
    ],
    [
        "missing bracket",
        "[[springs]]",
        "[[springs]",
        "line 22: unclosed array table, expected `]`: a list of tables has two brackets on either side, as in [[springs]]",
    ],
    [
        "missing quote",
        "unit = \"N m/rad\"",
        "unit = \"N m/rad",
        "line 10: missing comma between key-value pairs, expected `,`: a comma, a quote or a brace } is missing here or at the end of the line before",
    ],
    [
        "missing brace",
        "unit = \"N m/rad\", bounds = [1e-2, 1e7], source = \"example\" }",
        "unit = \"N m/rad\"",
        "line 11: missing comma between key-value pairs, expected `,`: a comma, a quote or a brace } is missing here or at the end of the line before",
    ],
    [
        "a number for a parameter",
        "stiffness = \"stiffness\"",
        "stiffness = 120",
        "line 26: stiffness must be the name of a parameter; write stiffness = \"k1\", and under [parameters] k1 = { value = 120, unit = \"N m/rad\" }",
    ],
    [
        "a parameter without unit",
        "stiffness = { value = 150, unit = \"N m/rad\",",
        "stiffness = { value = 150,",
        "line 10: unit is missing; write unit = \"N m/rad\" (a pure number has unit = \"1\")",
    ],
    [
        "a parameter as a plain number",
        "stiffness = { value = 150, unit = \"N m/rad\", bounds = [1e-2, 1e7], source = \"example\" }",
        "stiffness = 150",
        "line 10: expected a table like { value = 1.2, unit = \"N m/rad\" } instead of the integer `150`",
    ],
    [
        "a decimal comma",
        "value = 1.5e-3",
        "value = 1,5e-3",
        "line 8: extra comma in inline table, expected `=`: a decimal number has a point, as in 1.5",
    ],
    [
        "unknown unit",
        "N m/rad",
        "N m/radian",
        "line 10: parameters.stiffness.unit: \"N m/radian\" is no unit; expected something like \"N m/rad\", \"kg m2\" or \"1\"",
    ],
    [
        "a unit that does not fit the element",
        "N m/rad",
        "N/mm",
        "line 26: stiffness is parameter \"stiffness\" in \"N/mm\", but here a unit like \"N m/rad\" is expected",
    ],
    [
        "a mass for an inertia",
        "value = 4e-3, unit = \"kg m2\"",
        "value = 4e-3, unit = \"kg\"",
        "line 20: inertia is parameter \"load_inertia\" in \"kg\", but here a unit like \"kg m2\" is expected",
    ],
    [
        "unknown parameter",
        "stiffness = \"stiffness\"",
        "stiffness = \"stifness\"",
        "line 26: there is no parameter \"stifness\" (is `stiffness` meant?); declare it under [parameters], as in stifness = { value = 1, unit = \"N m/rad\" }",
    ],
    [
        "unused parameter",
        "[parameters]",
        "[parameters]\nk2 = { value = 90, unit = \"N m/rad\" }",
        "warning: nothing uses the parameter k2; name it where it belongs (as in damping = \"k2\"), or remove it",
    ],
    [
        "unknown node",
        "to = \"load\"",
        "to = \"laod\"",
        "line 25: there is no node \"laod\" (is `load` meant?); nodes are motor, load",
    ],
    [
        "node that nothing joins",
        "[[springs]]",
        "[[nodes]]\nname = \"disc\"\ninertia = \"load_inertia\"\n[[springs]]",
        "line 23: nothing drives disc: no spring, gear or shaft joins it to a place that has an input; join it, or remove it",
    ],
    [
        "node without mass or link behind a gear",
        "[[springs]]",
        "[[nodes]]\nname = \"out\"\n[[gears]]\nname = \"mesh\"\nfrom = \"load\"\nto = \"out\"\nratio = \"N\"\n[[springs]]",
        "warning: the gear mesh moves nothing: its node out has no inertia, and nothing else is tied to it; tie the part that it moves to out",
    ],
    [
        "spring between one node",
        "to = \"load\"",
        "to = \"motor\"",
        "line 25: a spring must join two different nodes; write another node, or to = \"ground\"",
    ],
    [
        "gear that closes a loop",
        "[[springs]]",
        "[[gears]]\nname = \"mesh\"\nfrom = \"motor\"\nto = \"load\"\nratio = \"N\"\n[[gears]]\nname = \"mesh_2\"\nfrom = \"motor\"\nto = \"load\"\nratio = \"N\"\n[[springs]]",
        "line 29: mesh_2 closes a rigid loop: its two nodes are tied already; remove it, or join one of them by a spring",
    ],
    [
        "ratio of 0",
        "[[springs]]",
        "[[gears]]\nname = \"mesh\"\nfrom = \"motor\"\nto = \"load\"\nratio = \"none\"\n[[springs]]",
        "line 27: ratio \"none\" is 0, but a gear of ratio N turns its `to` node N times slower; write another value than 0",
    ],
    [
        "negative inertia",
        "value = 4e-3",
        "value = -4e-3",
        "line 20: inertia \"load_inertia\" is -0.004 kg m2, but it must be positive; a node without inertia has no key inertia",
    ],
    [
        "value out of bounds",
        "value = 150",
        "value = 1e8",
        "line 10: parameters.stiffness.value is 100000000, outside its bounds 0.01 to 10000000; change either",
    ],
    [
        "bounds reversed",
        "bounds = [1e-2, 1e7]",
        "bounds = [1e7, 1e-2]",
        "line 10: parameters.stiffness.bounds must be [low, high] with low < high, as in bounds = [0.01, 10000000]",
    ],
    [
        "bounds of three numbers",
        "bounds = [1e-2, 1e7]",
        "bounds = [1e-2, 150, 1e7]",
        "line 10: parameters.stiffness.bounds must be two numbers; write bounds = [low, high]",
    ],
    [
        "duplicate name",
        "name = \"load_bearing\"",
        "name = \"motor_bearing\"",
        "line 34: the place \"motor_bearing\" is there already, in line 30; names must differ",
    ],
    [
        "duplicate parameter",
        "[parameters]",
        "[parameters]\nstiffness = { value = 90, unit = \"N m/rad\" }",
        "line 11: `stiffness` is there twice; remove one, or give it another name",
    ],
    [
        "no input",
        "role = \"input\"",
        "role = \"output\"",
        "line 38: [channels] has no input; write at least one channel with role = \"input\"",
    ],
    [
        "no output",
        "[channels.motor_speed]\nrole = \"output\"\nquantity = \"speed\"\nat = \"motor\"\n[channels.load_speed]\nrole = \"output\"\nquantity = \"speed\"\nat = \"load\"",
        "",
        "line 38: [channels] has no output; write at least one channel with role = \"output\"",
    ],
    [
        "unknown role",
        "role = \"input\"",
        "role = \"in\"",
        "line 39: there is no `in` here (is `input` meant?), expected `input` or `output`",
    ],
    [
        "unknown quantity",
        "quantity = \"speed\"",
        "quantity = \"velocity\"",
        "line 44: there is no `velocity` here (is `speed` meant?), expected one of `speed`, `angle`, `position`, `acceleration`, `force`, `torque`, `reference`, `voltage`, `current`",
    ],
    [
        "two speeds prescribed at one node",
        "quantity = \"torque\"\nat = \"motor\"",
        "quantity = \"speed\"\nat = \"motor\"\n[channels.encoder]\nrole = \"input\"\nquantity = \"speed\"\nat = \"motor\"",
        "line 42: channel encoder prescribes a speed that another input prescribes already; make one of them an output",
    ],
    [
        "torque and speed prescribed at one node",
        "[channels.motor_speed]\nrole = \"output\"",
        "[channels.motor_speed]\nrole = \"input\"",
        "warning: channel motor_torque moves nothing: the speed of motor is prescribed by channel motor_speed; make that one an output, or leave motor_torque out",
    ],
    [
        "torque measured at a node",
        "quantity = \"speed\"\nat = \"load\"",
        "quantity = \"torque\"\nat = \"load\"",
        "line 46: channel load_speed measures a torque at load, which is neither a spring nor a servo; a rigid part's torque is not known, so write at = one of shaft",
    ],
    [
        "speed of a spring",
        "quantity = \"speed\"\nat = \"load\"",
        "quantity = \"speed\"\nat = \"shaft\"",
        "line 46: channel load_speed needs a node, and shaft is none; write at = one of motor, load",
    ],
    [
        "angle as the input of a node",
        "quantity = \"torque\"",
        "quantity = \"angle\"",
        "line 38: channel motor_torque is an angle; as an input it is added to the twist of a spring, and motor is none; the motion of a node is given as quantity = \"speed\", of an encoder's column with take = \"rate\"",
    ],
    [
        "reference without a servo",
        "quantity = \"torque\"",
        "quantity = \"reference\"",
        "line 38: channel motor_torque is a reference, so it must be at the servo; write at = the name of a [servo]",
    ],
    [
        "voltage without a motor",
        "quantity = \"torque\"",
        "quantity = \"voltage\"",
        "line 38: channel motor_torque is a voltage, so it must be at one of the [[motors]], and motor is none; write a [[motors]] table with at = \"motor\", and its name here",
    ],
    [
        "current as an input",
        "quantity = \"torque\"",
        "quantity = \"current\"",
        "line 38: channel motor_torque is a current, which is an output of a motor; where it drives the model, write quantity = \"torque\", at = a node and scale = the torque constant",
    ],
    [
        "channel at an unknown place",
        "quantity = \"speed\"\nat = \"load\"",
        "quantity = \"speed\"\nat = \"lood\"",
        "line 49: there is no place \"lood\" (is `load` meant?); places are motor, load, shaft, motor_bearing, load_bearing",
    ],
    [
        "current read as torque",
        "quantity = \"torque\"\nat = \"motor\"",
        "quantity = \"torque\"\nat = \"motor\"\ncolumn = \"motor_current_A\"",
        "line 42: channels.motor_torque reads the column \"motor_current_A\" in A, but a torque is in N m; write scale = X, where one A is X N m",
    ],
    [
        "rpm without `unit`",
        "quantity = \"speed\"\nat = \"load\"",
        "quantity = \"speed\"\nat = \"load\"\ncolumn = \"tacho_1\"",
        "line 50: channels.load_speed reads the column \"tacho_1\" without a unit, but a speed is in rad/s; write unit = \"...\" with what it counts, or scale = X, where one count is X rad/s",
    ],
    [
        "scale of 0",
        "quantity = \"torque\"",
        "quantity = \"torque\"\nscale = 0",
        "line 38: channels.motor_torque needs a finite offset and a finite scale other than 0; leave scale out where the column is in SI",
    ],
    [
        "unknown effect",
        "[channels.motor_torque]",
        "[[effects]]\neffect = \"coulomb\"\nat = \"load_bearing\"\nparameters = { torque = \"T_c\" }\n[channels.motor_torque]",
        "line 40: there is no effect \"coulomb\" (is `coulomb_friction` meant?); effects are coulomb_friction, stribeck_friction, quadratic_drag, damping_drift, direction_dependence, velocity_weakening, constant_load, mesh_loss, backlash, kinematic_error, stiffness_hardening, hysteresis, missing_compliance, missing_inertia, coupling_slip, gravity_unbalance, external_disturbance, torque_ripple, sensor_gain, sensor_offset, sensor_lag, sensor_delay, sensor_saturation, sensor_fold, direction_gain, sensor_hum, sensor_ripple",
    ],
    [
        "effect at the wrong kind of place",
        "[channels.motor_torque]",
        "[[effects]]\neffect = \"coulomb_friction\"\nat = \"load\"\nparameters = { torque = \"T_c\" }\n[channels.motor_torque]",
        "line 41: coulomb_friction acts at a bearing, and \"load\" is none; write at = one of motor_bearing, load_bearing",
    ],
    [
        "effect without its parameter",
        "[channels.motor_torque]",
        "[[effects]]\neffect = \"coulomb_friction\"\nat = \"load_bearing\"\nparameters = { }\n[channels.motor_torque]",
        "line 39: coulomb_friction needs the parameter \"torque\"; write parameters = { torque = \"PARAMETER\" }",
    ],
    [
        "effect with a number",
        "[channels.motor_torque]",
        "[[effects]]\neffect = \"coulomb_friction\"\nat = \"load_bearing\"\nparameters = { torque = 0.1 }\n[channels.motor_torque]",
        "line 41: torque must be the name of a parameter; write torque = \"p1\", and under [parameters] p1 = { value = 0.1, unit = \"N m\" }",
    ],
    [
        "unknown parameter of an effect",
        "[channels.motor_torque]",
        "[[effects]]\neffect = \"coulomb_friction\"\nat = \"load_bearing\"\nparameters = { force = \"T_c\" }\n[channels.motor_torque]",
        "line 42: coulomb_friction has no parameter \"force\"; it has torque, transition_speed, deflection",
    ],
];

/// Parameters that some of the mistakes need, at the end of their table, so that lines stay.
const MORE: [(&str, &str); 3] = [
    ("\"N\"", "N = { value = 5, unit = \"1\" }\n"),
    ("\"none\"", "none = { value = 0, unit = \"1\" }\n"),
    ("\"T_c\"", "T_c = { value = 0.1, unit = \"N m\" }\n"),
];

fn message(from: &str, to: &str) -> String {
    let plain = BUILTIN[1].1;
    assert!(plain.contains(from), "{from} is not in the model file");
    let mut text = plain.replacen(from, to, 1);
    for (name, line) in MORE.iter().filter(|(name, _)| to.contains(name)) {
        assert!(text.contains(name));
        text = text.replacen("\n\n[[nodes]]", &format!("\n{line}\n[[nodes]]"), 1);
    }
    match Model::parse(&text) {
        Err(error) => error.to_string(),
        Ok(model) => format!("warning: {}", model.warnings().join("; ")),
    }
}

#[test]
fn each_mistake_has_its_message() {
    let cell = |text: &str| text.replace('|', "\\|");
    let lines =
        |text: &str| text.trim_end().lines().map(|line| format!("`{line}`")).collect::<Vec<_>>().join("<br>");
    let mut table = String::new();
    let mut wrong = Vec::new();
    for [what, from, to, expected] in MISTAKES {
        let found = message(from, to);
        if found != *expected {
            wrong.push(format!("{what}:\n    {found}"));
        }
        assert_eq!(found.lines().count(), 1, "{found}");
        assert!(found.starts_with("line ") || found.starts_with("warning: "), "{what}: {found}");
        let written = if to.is_empty() { "(the lines are missing)".to_owned() } else { lines(to) };
        table += &format!("| {what} | {} | {} |\n", cell(&written), cell(&found));
    }
    assert!(wrong.is_empty(), "messages that differ:\n{}", wrong.join("\n"));
    assert!(DOCUMENT.contains(&table), "docs/model-mistakes.md must hold this table:\n{table}");
}
