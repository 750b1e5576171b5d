use super::*;

/// Samples of a held input, and the sample time.
const INPUT: [f64; 60] = {
    let mut input = [0.0; 60];
    let mut k = 0;
    while k < 60 {
        input[k] = [3.0, -1.0, 2.0][k / 7 % 3];
        k += 1;
    }
    input
};
const SAMPLE_S: f64 = 1e-3;

fn reference(simulation: &Simulation, name: &str) -> usize {
    simulation.variables().iter().position(|variable| variable.name == name).unwrap()
}

/// The last outputs of a model after a step for each sample.
fn stepped(model: &Model) -> Vec<f64> {
    let mut simulation = Simulation::new(model.clone()).unwrap();
    let input = model.inputs().next().unwrap().name.clone();
    let input = reference(&simulation, &input);
    for value in INPUT {
        simulation.set(input, value).unwrap();
        assert_eq!(simulation.get(&[input]).unwrap(), [value]);
        simulation.step(SAMPLE_S).unwrap();
    }
    simulation.outputs().unwrap()
}

/// Outputs of one prediction over all samples, with time and the turned angle as columns.
fn predicted(model: &Model) -> Vec<f64> {
    let held = [&INPUT[..], &INPUT[59..]].concat();
    let mut kinds = vec![Intersample::Hold];
    let mut columns = vec![held];
    for clock in model.inputs().skip(1) {
        kinds.push(Intersample::Linear);
        let slope = |k: usize| if clock.quantity == Quantity::Time { 1.0 } else { INPUT[k] };
        let ends = (0..60).scan(0.0, |sum, k| {
            *sum += SAMPLE_S * slope(k);
            Some(*sum)
        });
        columns.push([0.0].into_iter().chain(ends).collect());
    }
    let predictor = Predictor::new(model, &model.values(), SAMPLE_S).unwrap();
    let slices: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let still = vec![0.0; predictor.states()];
    let found = predictor.run(&slices, &kinds, Start::State(&still)).unwrap();
    found.outputs.iter().map(|output| output[60]).collect()
}

fn assert_close(found: &[f64], expected: &[f64], relative: f64) {
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= relative * expected.abs(), "{found} for {expected}");
    }
}

#[test]
fn steps_continue_each_other() {
    let model = Model::builtin("two-mass").unwrap();
    assert_close(&stepped(&model), &predicted(&model), 1e-10);
    let emps = Model::builtin("emps").unwrap();
    assert_close(&stepped(&emps), &predicted(&emps), 1e-6);
}

#[test]
fn time_and_turned_angle_are_kept_by_the_simulation() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let unbalance = [("torque", 0.3), ("phase", 0.4)];
    let model = model.with_effect("gravity_unbalance", "load", &unbalance).unwrap();
    let drifting = model.with_effect("damping_drift", "load_bearing", &[("rate", 5.0)]).unwrap();
    assert_eq!(drifting.inputs().count(), 3);
    let mut simulation = Simulation::new(drifting.clone()).unwrap();
    assert!(
        simulation.variables().iter().all(|v| !matches!(v.kind, VariableRole::Input(index) if index > 0))
    );
    assert_close(&stepped(&drifting)[..1], &predicted(&drifting)[..1], 1e-6);
    // Without the clocks the result would differ.
    assert!((stepped(&drifting)[0] - stepped(&model)[0]).abs() > 1e-5);
    // Time counts from the start, wherever that is.
    simulation.start_at(40.0).unwrap();
    simulation.step(0.02).unwrap();
    let moved = simulation.outputs().unwrap();
    simulation.reset();
    simulation.step(0.02).unwrap();
    assert_close(&moved, &simulation.outputs().unwrap(), 1e-9);
}

#[test]
fn a_step_that_fails_changes_nothing() {
    let mut simulation = Simulation::new(Model::builtin("two-mass").unwrap()).unwrap();
    let speed = reference(&simulation, "state.speed_of_load");
    simulation.set(speed, f64::MAX).unwrap();
    let before = simulation.snapshot().clone();
    assert!(simulation.step(0.1).is_err());
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
        assert!(matches!(simulation.step(wrong), Err(FmuError::Argument(_))), "{wrong}");
    }
    assert_eq!(simulation.snapshot(), &before);
    assert!(simulation.set(speed, f64::NAN).is_err());
}

/// Also where laws act on massless nodes and see each other's forces.
#[test]
fn derivatives_are_rates_of_short_steps() {
    let cam = Model::builtin("speed-o-cam").unwrap();
    let drifting = cam.with_effect("damping_drift", "load_bearing", &[("rate", 5.0)]).unwrap();
    let bearing = "[[bearings]]\nname = \"sensor_bearing\"\nat = \"torque_sensor_in\"\n";
    let held = Model::parse(&format!("{}\n{bearing}", cam.text)).unwrap();
    let coupled = held.with_effect("coulomb_friction", "sensor_bearing", &[("torque", 0.02)]).unwrap();
    assert!(coupled.equations(&coupled.values()).unwrap().port_force.amax() > 0.0);
    // A law of the file, which sees another channel, and a curve over time.
    let parameters = "[parameters]\na = { value = 0.3, unit = \"N m\" }\nb = { value = 50, unit = \"rpm\" }";
    let brake = "[[laws]]\nname = \"brake\"\nat = \"load_bearing\"\nformula = \"-curve*tanh(speed/b) - 0.2*motor_torque\"\ncurve = { over = \"time\", at = [1, 2, 3], values = [0.1, 0.2, 0.4], unit = \"N m\" }";
    let two_mass = Model::builtin("two-mass").unwrap().text.replacen("[parameters]", parameters, 1);
    let own = Model::parse(&format!("{two_mass}\n{brake}\n")).unwrap();
    for model in [Model::builtin("emps").unwrap(), drifting, coupled, own] {
        let mut simulation = Simulation::new(model).unwrap();
        simulation.start_at(2.0).unwrap();
        simulation.set(1, 3.0).unwrap();
        simulation.step(0.02).unwrap();
        let (before, rates) = (simulation.snapshot().clone(), simulation.derivatives().unwrap());
        let step_s = 1e-7;
        simulation.step(step_s).unwrap();
        let largest = rates.iter().fold(0.0, |largest: f64, rate| largest.max(rate.abs()));
        assert!(largest > 0.0);
        for ((after, before), rate) in simulation.snapshot().state.iter().zip(&before.state).zip(&rates) {
            assert!(((after - before) / step_s - rate).abs() < 1e-3 * largest, "{rate}");
        }
    }
}

#[test]
fn a_turned_angle_is_only_for_co_simulation() {
    let model = Model::builtin("speed-o-cam").unwrap();
    assert!(Simulation::new(model.clone()).unwrap().check_exchange().is_ok());
    let turning = model.with_effect("gravity_unbalance", "load", &[("torque", 0.3), ("phase", 0.4)]).unwrap();
    let simulation = Simulation::new(turning).unwrap();
    assert!(simulation.check_exchange().is_err());
    assert!(!simulation.variables().iter().any(|variable| variable.name.starts_with("der(")));
}
