use super::draw::Chosen;
use super::*;
use crate::Plant;

#[test]
fn drawing_depends_on_seed_and_number_alone() {
    for number in 0..12 {
        assert_eq!(Case::draw(3, number).unwrap(), Case::draw(3, number).unwrap());
        assert_eq!(family_of(3, number), Case::draw(3, number).unwrap().machine.family);
    }
    assert_ne!(Case::draw(3, 0).unwrap(), Case::draw(4, 0).unwrap());
}

#[test]
fn every_forty_cases_hold_the_same_kinds_clean_and_realistic() {
    for realistic in [false, true] {
        let of = |kind: CaseKind| {
            (0..40)
                .filter(|number| is_realistic(*number) == realistic && CaseKind::of(*number) == kind)
                .count()
        };
        assert_eq!(
            [CaseKind::Clean, CaseKind::Single, CaseKind::Double, CaseKind::Outside].map(of),
            [8, 7, 3, 2]
        );
    }
}

#[test]
fn all_families_and_all_effects_get_their_turn() {
    let drawn: Vec<_> = (0..400).map(|number| (number, outline(number, &mut Draw::new(1, number)))).collect();
    for family in FAMILY_NAMES {
        assert!(drawn.iter().any(|(_, (machine, _))| machine.family == family), "{family}");
    }
    for (number, (_, chosen)) in &drawn {
        let expected = match CaseKind::of(*number) {
            CaseKind::Clean => 0,
            CaseKind::Single | CaseKind::Outside => 1,
            CaseKind::Double => 2,
        };
        assert_eq!(chosen.len(), expected);
    }
    for effect in hidden::NAMED.iter().chain(&hidden::OUTSIDE) {
        for realistic in [false, true] {
            let hides = |number: u64, chosen: &[Chosen]| {
                is_realistic(number) == realistic && chosen.iter().any(|(other, _)| other == effect)
            };
            assert!(drawn.iter().any(|(number, (_, chosen))| hides(*number, chosen)), "{effect}");
        }
    }
    assert!(hidden::NAMED.iter().all(|effect| socam_model::effects::find(effect).is_some()));
}

/// The columns of the first recording of a case with these hidden effects and without noise.
fn recorded(case: &Case, hidden: Vec<Hidden>) -> Vec<Vec<f64>> {
    let mut case = Case { hidden, noise_std: Vec::new(), training: 1, ..case.clone() };
    case.runs.truncate(1);
    let data = case.record().unwrap().training.remove(0);
    data.load_all().unwrap().columns.iter().map(|column| column.values().to_vec()).collect()
}

#[test]
fn everything_that_can_be_hidden_in_a_family_runs_and_shows() {
    for (turn, (family, make)) in FAMILIES.into_iter().enumerate() {
        let draw = &mut Draw::new(7, 0);
        let mut machine = make(draw);
        let (mut runs, _) = runs(&machine, draw);
        runs.truncate(1);
        runs[0].duration_s = 5.0;
        machine.sensors.iter_mut().for_each(|sensor| sensor.step = 0.0);
        let scales = Scales::of(&machine, &runs[0]).unwrap();
        let case = Case {
            runs,
            machine,
            ..Case { kind: CaseKind::Single, background: Background::default(), ..Case::draw(1, 0).unwrap() }
        };
        let plain = recorded(&case, Vec::new());
        // With the default bench's massless points, the truth's integrator needs many small steps.
        let effects: Vec<_> = match family {
            "speed-o-cam" => vec!["backlash", "missing_compliance"],
            // Each family is tested with a third of the effects, so that each effect is tested in three families.
            _ => hidden::NAMED.into_iter().chain(hidden::OUTSIDE).skip(turn % 3).step_by(3).collect(),
        };
        for effect in effects {
            // One place suffices, because all places share the law.
            for place in hidden::places(&case.machine, effect).into_iter().take(1) {
                let hidden = hidden::hide(effect, &place, &case.machine, &scales, draw);
                let shown = recorded(&case, vec![hidden.clone()]);
                let change = plain.iter().zip(&shown).zip(&scales.channels).map(|((a, b), size)| {
                    let worst = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    worst / size
                });
                let change = change.fold(0.0, f64::max);
                assert!(change > 2e-3 && change.is_finite(), "{family}: {hidden:?} changes {change}");
            }
        }
    }
}

/// Outputs of a model for an input that is linear between samples.
fn simulated(model: &Model, rate_hz: f64, input: &[f64]) -> Vec<Vec<f64>> {
    let plant = Plant::new(model, &model.values()).unwrap();
    let mut trajectory = plant.start().unwrap();
    trajectory.set_input(&input[..1]);
    let mut now = vec![0.0; model.outputs().count()];
    let mut outputs = vec![Vec::new(); now.len()];
    for (sample, value) in input.iter().enumerate() {
        if sample > 0 {
            trajectory.ramp(sample as f64 / rate_hz, &[*value]).unwrap();
        }
        trajectory.outputs(&mut now);
        outputs.iter_mut().zip(&now).for_each(|(output, value)| output.push(*value));
    }
    outputs
}

/// The truth distinguishes the sides by the direction of the power and has a compliant contact; the catalogue blends two shares.
#[test]
fn a_loss_by_driving_side_is_that_of_the_catalogue() {
    let draw = &mut Draw::new(7, 0);
    let (_, make) = FAMILIES.into_iter().find(|(family, _)| *family == "geared").unwrap();
    let mut machine = make(draw);
    machine.sensors.iter_mut().for_each(|sensor| sensor.step = 0.0);
    let (mut runs, _) = runs(&machine, draw);
    runs[0].duration_s = 2.0;
    let scales = Scales::of(&machine, &runs[0]).unwrap();
    let draws = Case::draw(1, 0).unwrap();
    let case = Case { runs, machine, background: Background::default(), ..draws };
    let mut hidden = hidden::hide("mesh_loss", "stage_1", &case.machine, &scales, draw);
    hidden.parameters = vec![("fraction".into(), 0.2), ("back_fraction".into(), 0.5)];
    let plain = recorded(&case, Vec::new());
    let truth = recorded(&case, vec![hidden.clone()]);
    let base = Model::parse(&case.machine.model_file()).unwrap();
    // Distance of a model's outputs from the truth's, as a share of what the loss changes.
    let miss = |back: Option<f64>| {
        let widths = [("transition_speed", hidden.own[0]), ("transition_torque", hidden.own[1])];
        let shares = [Some(("fraction", 0.2)), back.map(|back| ("back_fraction", back))];
        let values: Vec<(&str, f64)> = shares.into_iter().flatten().chain(widths).collect();
        let model = base.with_effect("mesh_loss", "stage_1", &values).unwrap();
        let outputs = simulated(&model, case.machine.rate_hz, &truth[0]);
        let square = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let each = outputs.iter().zip(truth.iter().zip(&plain).skip(1));
        each.map(|(own, (lossy, plain))| (square(own, lossy) / square(plain, lossy)).sqrt())
            .fold(0.0, f64::max)
    };
    let [right, less, equal] = [Some(0.5), Some(0.4), None].map(miss);
    println!("missed: {right}, {less}, {equal}");
    assert!(right < 0.02 && less > 4.0 * right && equal > 10.0 * right, "{right}, {less}, {equal}");
}

#[test]
fn what_a_diagnosis_gets_holds_no_truth() {
    let case = Case::draw(1, 2).unwrap();
    assert!(!case.hidden.is_empty());
    let base = case.base().unwrap();
    assert_eq!(base.text, case.without_hidden().base().unwrap().text);
    for parameter in case.machine.parameters.iter().filter(|parameter| !parameter.fixed) {
        let known = &base.parameters[base.parameter(&parameter.name).unwrap()];
        let wrong = known.value / parameter.value;
        assert!((1.0 / 3.1..3.1).contains(&wrong) && wrong != 1.0, "{parameter:?}");
    }
}
