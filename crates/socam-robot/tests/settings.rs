//! Axes from gains of SysId and from settings of a moteus and of an ODrive, against their equations by hand.

use nalgebra::Complex;
use socam_model::Model;
use socam_robot::{Controller, Drive, SysId};

const TURN: f64 = std::f64::consts::TAU;

const MOTEUS: &str = "# moteus_tool -t 1 --dump-config
id.id 3
motor.poles 14
motor.phase_invert 0
motor.resistance_ohm 0.05
motor.inductance_d_H 3.0e-05
motor.Kv 300.0
motor.rotation_current_cutoff_A 10000.0
servo.max_current_A 20.0
servo.max_velocity 500.0
servo.pid_position.kp 4.0
servo.pid_position.ki 1.0
servo.pid_position.kd 0.2
servo.default_velocity_limit nan
motor_position.sources.0.cpr 16384
motor_position.rotor_to_output_ratio 0.125
OK
";

/// As firmware 0.5 has it: one in another, with an infinity, which JSON has not.
const ODRIVE_5: &str = r#"{"axis0": {"motor": {"config": {"torque_constant": 0.04, "phase_resistance": 0.1, "phase_inductance": 2e-5,
  "pole_pairs": 7, "current_lim": 10.0, "torque_lim": Infinity, "motor_type": 0}},
  "controller": {"config": {"pos_gain": 20.0, "vel_gain": 0.16, "vel_integrator_gain": 0.32, "vel_limit": 2.0, "inertia": 0.001}},
  "encoder": {"config": {"cpr": 8192, "name": "with \"Infinity\""}}},
 "axis1": {"motor": {"config": {"torque_constant": 0.06}}}}"#;

/// As firmware 0.6 has it: by paths.
const ODRIVE_6: &str = r#"{"axis0.config.motor.torque_constant": 0.04, "axis0.config.motor.phase_resistance": 0.1,
  "axis0.config.motor.current_soft_max": 10.0, "axis0.config.torque_soft_max": 0.3, "axis0.config.motor.motor_type": 2,
  "axis0.controller.config.pos_gain": 20.0, "axis0.controller.config.vel_gain": 0.16, "inc_encoder0.config.cpr": 4096,
  "config.list": [1, 2]}"#;

fn model(text: &str) -> Model {
    Model::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn value(model: &Model, name: &str) -> f64 {
    model.parameters[model.parameter(name).unwrap()].value
}

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} for {expected}");
}

/// Response of the first output to the first input at 2 rad/s.
fn response(model: &Model) -> Complex<f64> {
    model.equations(&model.values()).unwrap().transfer(0, 0, Complex::new(0.0, 2.0)).unwrap()
}

fn alike(found: Complex<f64>, expected: Complex<f64>) {
    assert!((found - expected).norm() < 1e-6 * expected.norm(), "{found} for {expected}");
}

#[test]
fn gains_of_sysid_are_the_models_parameters() {
    let s = Complex::new(0.0, 2.0);
    for (unit, size) in [
        ("rotations", TURN),
        ("Radians", 1.0),
        ("degrees", TURN / 360.0),
        ("Meters", 1.0),
        ("inches", 0.0254),
    ] {
        let gains = SysId::parse(&format!("kS = 0.12, kV: 0.8 ka=0.03 unit={unit}")).unwrap();
        let model = model(&gains.model_file());
        // V = kV speed + kA acceleration.
        alike(response(&model), size / (s * (0.8 + 0.03 * s)));
        near(value(&model, "kS"), 0.12);
    }
    let arm = SysId::parse("ks=0.1 kv=1 ka=0.05 kg=0.4 offset=0.2 unit=radians mechanism=arm").unwrap();
    let model = model(&arm.model_file());
    // T = -kG cos(angle + 0.2).
    let weight = -value(&model, "kG") * (0.3 + value(&model, "horizontal")).sin();
    near(weight, -0.4 * 0.5_f64.cos());
    assert!(arm.left_out()[0].contains("1 N m/V"), "{:?}", arm.left_out());
}

#[test]
fn gains_that_say_too_little_are_refused_in_a_sentence() {
    for (gains, sentence) in [
        ("ks=0.1 kv=1 unit=rad", "have no `ka`"),
        ("ks=0.1 kv=1 ka=0.1", "have no `unit`"),
        ("ks=0.1 kv=1 ka=0 unit=rad", "kv or ka of zero or less"),
        ("ks=0.1 kv=one ka=0.1 unit=rad", "`kv=one`, whose value is no number"),
        ("ks=0.1 kv=1 ka=0.1 unit=furlong", "by `furlong`"),
        ("ks=0.1 kv=1 ka=0.1 unit=rad kg=1", "add mechanism="),
        ("ks=0.1 kv=1 ka=0.1 unit=m kg=1 mechanism=arm", "whose unit is rotations"),
        ("ks=0.1 kv=1 ka=0.1 unit=m mechanism=elevator", "have no `kg`"),
        ("ks=0.1 kp=1", "`kp`, which is none of SysId's"),
    ] {
        let said = SysId::parse(gains).unwrap_err().to_string();
        assert!(said.contains(sentence), "{gains}: {said}");
    }
}

#[test]
fn a_moteus_becomes_an_axis_for_each_drive() {
    let axis = Controller::parse(MOTEUS, None).unwrap();
    let (text, left_out) = axis.model_file("moteus.cfg", Drive::Current).unwrap();
    let by_current = model(&text);
    near(value(&by_current, "gear_ratio"), 8.0);
    // A torque of the rotor is 8 times that at the output.
    let (inertia, damping) = (
        value(&by_current, "inertia") + 64.0 * value(&by_current, "rotor_inertia"),
        value(&by_current, "damping"),
    );
    let s = Complex::new(0.0, 2.0);
    let constant = 8.269_933_431_326_88 / 300.0;
    alike(response(&by_current), 8.0 / (s * (inertia * s + damping)));
    assert!(text.contains("scale = 0.02756644"), "{text}");
    for part in [
        "friction and damping: no setting",
        "the inertia: no setting",
        "servo.pid_position.ki = 1",
        "7 pole pairs (line 3, motor.poles)",
        "the resistance, 0.05 ohm (line 5",
    ] {
        assert!(left_out.iter().any(|text| text.contains(part)), "{part}: {left_out:?}");
    }
    assert!(text.contains("8.27/Kv of 300 rpm/V (line 7, motor.Kv)"), "{text}");
    assert!(text.contains("16384 counts"), "{text}");

    let by_voltage = model(&axis.model_file("moteus.cfg", Drive::Voltage).unwrap().0);
    near(value(&by_voltage, "torque_constant"), constant);
    // 60/(2 pi sqrt 3) by Kv: the peak of a phase.
    near(value(&by_voltage, "back_emf"), 60.0 / (TURN * 3.0_f64.sqrt() * 300.0));
    near(value(&by_voltage, "inductance"), 3e-5);

    let by_reference = model(&axis.model_file("moteus.cfg", Drive::Reference).unwrap().0);
    // torque = kp (reference - position) - kd speed, in N m for a turn.
    let (inertia, damping) = (value(&by_reference, "inertia"), value(&by_reference, "damping"));
    let (kp, kd) = (4.0 / TURN, 0.2 / TURN);
    alike(response(&by_reference), kp / (inertia * s * s + (damping + kd) * s + kp));
    near(value(&by_reference, "torque_limit"), 20.0 * constant * 8.0);
}

#[test]
fn an_odrive_of_either_firmware_becomes_an_axis() {
    let old = Controller::parse(ODRIVE_5, Some("axis0")).unwrap();
    let by_reference = model(&old.model_file("odrive.json", Drive::Reference).unwrap().0);
    near(value(&by_reference, "position_gain"), 20.0);
    near(value(&by_reference, "velocity_gain"), 0.16 / TURN);
    near(value(&by_reference, "torque_limit"), 0.4);
    near(value(&by_reference, "inertia"), 0.001 / TURN);
    let (text, left_out) = old.model_file("odrive.json", Drive::Current).unwrap();
    assert!(text.contains("scale = 0.040000000") && text.contains("8192 counts"), "{text}");
    let integral = "axis0.controller.config.vel_integrator_gain = 0.32: ";
    assert!(left_out.iter().any(|text| text.starts_with(integral)), "{left_out:?}");

    let new = Controller::parse(ODRIVE_6, None).unwrap();
    let by_reference = model(&new.model_file("odrive.json", Drive::Reference).unwrap().0);
    near(value(&by_reference, "torque_limit"), 0.3);
    assert!(new.left_out.iter().any(|text| text.contains("a gimbal's motor")), "{:?}", new.left_out);
    assert!(new.model_file("odrive.json", Drive::Voltage).unwrap().0.contains("4096 counts"));
}

#[test]
fn settings_that_say_too_little_are_refused_in_a_sentence() {
    let said = |text: &str, axis: Option<&str>, drive: Drive| {
        let read = Controller::parse(text, axis).and_then(|axis| axis.model_file("x", drive));
        read.unwrap_err().to_string()
    };
    let by = Drive::Current;
    assert!(said(ODRIVE_5, None, by).contains("has several axes; name one by --joint: `axis0`, `axis1`"));
    assert!(said(ODRIVE_5, Some("axis2"), by).contains("has no axis `axis2`"));
    assert!(said(ODRIVE_5, Some("axis1"), Drive::Voltage).contains("states no resistance above zero"));
    assert!(said("{\"axis0\":\n {", None, by).starts_with("line 2: is no JSON"));
    assert!(said("{}", None, by).contains("no torque constant of an ODrive's axis"));
    assert!(said("motor.Kv\n", None, by).starts_with("line 1: holds `motor.Kv`"));
    assert!(said("a.b 1\n", None, by).contains("holds no settings of a motor"));
    assert!(
        said(&MOTEUS.replace("Kv 300.0", "Kv fast"), None, by).starts_with("line 7: `motor.Kv` is `fast`")
    );
    let uncalibrated = MOTEUS.replace("Kv 300.0", "Kv 0.0");
    assert!(said(&uncalibrated, None, by).contains("states no torque constant"));
    assert!(Controller::parse(&uncalibrated, None).unwrap().model_file("x", Drive::Reference).is_ok());
    assert!(said(MOTEUS, Some("elbow"), by).contains("is of one axis, `moteus_3`"));
}
