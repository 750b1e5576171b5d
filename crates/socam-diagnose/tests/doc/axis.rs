{
    // For the examples of the documentation: a model of a carriage with viscous friction, and four recordings (2 s at 200 Hz) of one that
    // has Coulomb friction too. It is one expression, so that `include!` gives its value.
    const MODEL: &str = r#"
schema = "socam.model/1"
name = "axis"
description = "a carriage with viscous friction"
motion = "translation"

[parameters]
mass = { value = 10, unit = "kg", bounds = [1, 100], source = "guess" }
viscous = { value = 20, unit = "N s/m", bounds = [0, 1000], source = "guess" }

[[nodes]]
name = "carriage"
inertia = "mass"

[[bearings]]
name = "guide"
at = "carriage"
damping = "viscous"

[channels.force]
role = "input"
quantity = "force"
at = "carriage"
[channels.speed]
role = "output"
quantity = "speed"
at = "carriage"
"#;

    // `pace` shifts the frequencies of the force.
    let record = |name: &str, pace: f64| {
        use socam_recording::{Channel, Dataset, Unit};
        let (mut speed, mut noise) = (0.0_f64, 1u64);
        let (mut time_s, mut forces, mut speeds) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..400 {
            let t = 0.005 * f64::from(k);
            let force = |t: f64| 30.0 * ((9.0 + pace) * t).sin() + 20.0 * ((23.0 - pace) * t).sin();
            noise = noise.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            time_s.push(t);
            forces.push(force(t));
            speeds.push(speed + 2e-3 * ((noise >> 11) as f64 / 2f64.powi(53) - 0.5));
            for part in 0..100 {
                let friction = 5.0 * (speed / 1e-3_f64).tanh();
                speed += 5e-5 * (force(t + 5e-5 * f64::from(part)) - 25.0 * speed - friction) / 12.0;
            }
        }
        let channels = vec![Channel::new("force", Unit::N), Channel::new("speed", Unit::MPerS)];
        Dataset::from_columns(name, channels, time_s, vec![forces, speeds]).unwrap()
    };
    (socam_model::Model::parse(MODEL)?, [record("a", 0.0), record("b", 1.5), record("c", 3.0), record("d", 2.0)])
}
