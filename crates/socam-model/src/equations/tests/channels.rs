//! Inputs and outputs of the equations: gains, transforms of a column, and angles added to a spring's twist.

use super::p;
use crate::{ChannelTransform, Model, Quantity};

/// A gain scales the column of its input or the row of its output once; its derivative is the unscaled matrix.
#[test]
fn a_gain_multiplies_its_channel_alone() {
    let plain = Model::builtin("two-mass").unwrap();
    let parameter = |name| format!("{name} = {{ value = 1.25, unit = \"1\" }}\n\n[[nodes]]");
    let text = plain.text.replacen("[[nodes]]", &parameter("drive"), 1);
    let text = text.replacen("[[nodes]]", &parameter("tacho"), 1);
    let text = text.replacen("[channels.motor_torque]", "[channels.motor_torque]\ngain = \"drive\"", 1);
    let model =
        Model::parse(&text.replacen("[channels.load_speed]", "[channels.load_speed]\ngain = \"tacho\"", 1));
    let model = model.unwrap();
    let wrt = ["drive", "tacho"].map(|name| model.parameter(name).unwrap());
    let (scaled, derivatives) = model.equations_with_derivatives(&model.values(), &wrt).unwrap();
    let plain = plain.equations(&plain.values()).unwrap();
    let gains = nalgebra::DVector::from_row_slice(&[1.0, 1.25]);
    let output = nalgebra::DMatrix::from_diagonal(&gains) * &plain.output;
    assert!((&scaled.input - &plain.input * 1.25).amax() < 1e-9 && (&scaled.output - output).amax() < 1e-12);
    assert_eq!(scaled.state, plain.state);
    assert!((&derivatives[0].input - &plain.input).amax() < 1e-9 && derivatives[0].output.amax() == 0.0);
    assert!(
        (derivatives[1].output.row(1) - plain.output.row(1)).amax() < 1e-12
            && derivatives[1].input.amax() == 0.0
    );
    let other_unit = text.replacen("\"drive\"", "\"stiffness\"", 1);
    assert!(Model::parse(&other_unit).unwrap_err().to_string().contains("stiffness"));
}

#[test]
fn an_input_may_be_made_of_an_angle() {
    let plain = Model::builtin("speed-o-cam").unwrap();
    assert!(plain.channels.iter().all(|channel| channel.transform == ChannelTransform::Value));
    let at = "[channels.motor_speed]\nrole = \"input\"\n";
    assert!(plain.text.contains(at));
    let with = |lines: &str| Model::parse(&plain.text.replacen(at, &format!("{at}{lines}\n"), 1));
    let model = with("column = \"encoder_rad\"\ntake = \"rate\"").unwrap();
    let input = model.inputs().next().unwrap();
    assert_eq!((input.column.as_str(), input.transform), ("encoder_rad", ChannelTransform::Rate));
    // The angle of a law is then the column of the encoder, without integration.
    let eccentric = [("order", 1.0), ("amplitude", 1e-3), ("phase", 0.0)];
    let clock = |model: &Model| {
        let grown = model.with_effect("kinematic_error", "mesh", &eccentric).unwrap();
        let clock = grown.inputs().find(|input| input.quantity == Quantity::Turned).unwrap();
        (clock.column.clone(), clock.transform)
    };
    assert_eq!(clock(&model), ("encoder_rad".into(), ChannelTransform::Value));
    assert_eq!(clock(&plain), ("motor_speed_rad_s".into(), ChannelTransform::Integral));
    let wave = with("column = \"encoder_rad\"\ntake = { sin = 2 }").unwrap();
    assert_eq!(wave.inputs().next().unwrap().transform, ChannelTransform::Sin(2.0));
    assert_eq!(clock(&wave), ("output_speed_rad_s".into(), ChannelTransform::Integral));
    // A file with updated values keeps the transform.
    let update = crate::Update { name: "k4".into(), value: 100.0, ci95: None, source: "test".into() };
    let written = Model::parse(&model.text_with(&[update]).unwrap()).unwrap();
    assert_eq!(written.channels, model.channels);

    let refused = |lines: &str, words: &[&str]| {
        let text = with(lines).unwrap_err().to_string();
        assert!(words.iter().all(|word| text.contains(word)) && text.lines().count() == 1, "{lines}: {text}");
    };
    refused("take = \"rate\"", &["motor_speed.take", "angle", "column ="]);
    refused("column = \"tacho_rad_s\"\ntake = \"rate\"", &["motor_speed.take", "angle"]);
    refused("column = \"encoder_rad\"\ntake = \"mean\"", &["mean", "rate", "cos", "sin"]);
    refused("column = \"encoder_rad\"\ntake = { cos = 0 }", &["order", "other than zero"]);
    refused("column = \"encoder_rad\"\ntake = { sin = inf }", &["order", "finite"]);
    let output = "[channels.output_speed]\nrole = \"output\"\n";
    let text = plain.text.replacen(output, &format!("{output}column = \"x_rad\"\ntake = \"rate\"\n"), 1);
    assert!(Model::parse(&text).unwrap_err().to_string().contains("output is read as recorded"));
}

#[test]
fn a_law_takes_its_angle_from_the_model_where_an_angle_is_measured() {
    let gravity = [("torque", 0.5), ("phase", 0.0)];
    let turned = |more: &str| {
        let model = Model::parse(&format!("{}{more}", crate::BUILTIN[1].1)).unwrap();
        let swinging = model.with_effect("gravity_unbalance", "load", &gravity).unwrap();
        swinging.inputs().any(|input| input.quantity == Quantity::Turned)
    };
    assert!(turned(""));
    assert!(!turned("[channels.load_angle]\nrole = \"output\"\nquantity = \"angle\"\nat = \"load\"\n"));
}

#[test]
fn an_angle_that_is_put_into_a_spring_twists_it() {
    let text = crate::BUILTIN[1].1;
    let error = "[channels.error]\nrole = \"input\"\nquantity = \"angle\"\nat = \"shaft\"\ngain = \"size\"\n\
                 [channels.shaft_torque]\nrole = \"output\"\nquantity = \"torque\"\nat = \"shaft\"\n";
    let size = "[parameters]\nsize = { value = 0.5, unit = \"1\" }";
    let model = Model::parse(&format!("{}{error}", text.replacen("[parameters]", size, 1))).unwrap();
    let values = model.values();
    let k = model.parameter("stiffness").unwrap();
    let (e, derivatives) =
        model.equations_with_derivatives(&values, &[k, model.parameter("size").unwrap()]).unwrap();
    let plain = Model::parse(text).unwrap().equations(&Model::parse(text).unwrap().values()).unwrap();
    assert_eq!((&e.state, e.input.column(0)), (&plain.state, plain.input.column(0)));
    // States: wind-up of the load, speed of the motor, speed of the load. Input 1 is the angle, output 2 the shaft's torque.
    let pull = 0.5 * p(&model, "stiffness");
    let expected = [0.0, -pull / p(&model, "motor_inertia"), pull / p(&model, "load_inertia")];
    for (row, expected) in expected.iter().enumerate() {
        assert!((e.input[(row, 1)] - expected).abs() < 1e-9 * pull / 1e-3, "{row}: {}", e.input);
    }
    assert_eq!(e.feedthrough[(2, 1)], pull);
    // Twist by wind-up and twist by the input give the same torque.
    assert!((e.output[(2, 0)] * 0.5 + e.feedthrough[(2, 1)]).abs() < 1e-12 * pull, "{}", e.output);
    assert_eq!((derivatives[0].feedthrough[(2, 1)], derivatives[1].feedthrough[(2, 1)]), (0.5, 2.0 * pull));
    assert!((derivatives[1].input.column(1) * 0.5 - e.input.column(1)).amax() < 1e-9);
    let text =
        model.text.replacen("quantity = \"angle\"\nat = \"shaft\"", "quantity = \"angle\"\nat = \"load\"", 1);
    let refused = Model::parse(&text).unwrap_err().to_string();
    assert!(refused.contains("error") && refused.contains("twist of a spring"), "{refused}");
}
