//! The torsional drivetrain bench of Aalto University: the published chain of 22 inertias.

use socam_model::Model;

#[test]
fn the_published_chain_has_its_published_modes() {
    let mut model = Model::parse(include_str!("../models/aalto.toml")).unwrap();
    // Published are the modes of the undamped chain.
    for parameter in &mut model.parameters {
        if parameter.unit == "N m s/rad" {
            parameter.value = 0.0;
        }
    }
    let modes = model.equations(&model.values()).unwrap().modes();
    let mut frequencies: Vec<f64> = modes.iter().map(|mode| mode.natural_frequency_hz).collect();
    // The free rotation comes first.
    frequencies.retain(|frequency| *frequency > 1.0);
    assert!(frequencies.len() >= 4, "{frequencies:?}");
    for (found, published) in frequencies.iter().zip([29.62, 39.65, 77.61, 359.7]) {
        assert!((found - published).abs() < 0.1, "{found} Hz is not {published} Hz");
    }
}
