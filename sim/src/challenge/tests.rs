use super::*;

#[test]
fn drawing_depends_on_seed_and_number_alone() {
    for number in 0..60 {
        assert_eq!(Case::draw(3, number).unwrap(), Case::draw(3, number).unwrap());
        assert_ne!(Case::draw(3, number).unwrap().parameters, Case::draw(4, number).unwrap().parameters);
    }
}

#[test]
fn every_twenty_cases_hold_some_of_each_kind() {
    let cases: Vec<Case> = (0..40).map(|number| Case::draw(1, number).unwrap()).collect();
    let count = |kind: Kind| cases[..20].iter().filter(|case| case.kind == kind).count();
    assert_eq!([Kind::Clean, Kind::Single, Kind::Double, Kind::Outside].map(count), [8, 7, 3, 2]);
    assert!(cases[..20].iter().all(|case| !case.locked) && cases[20..].iter().all(|case| case.locked));
    for case in &cases {
        let expected = match case.kind {
            Kind::Clean => 0,
            Kind::Single | Kind::Outside => 1,
            Kind::Double => 2,
        };
        assert_eq!(case.hidden.len(), expected);
        assert_eq!(case.runs.len(), runs::TRAINING + 2);
    }
}

#[test]
fn all_effects_get_their_turn_in_either_half() {
    for locked in [false, true] {
        let cases =
            (0..400).map(|number| Case::draw(1, number).unwrap()).filter(|case| case.locked == locked);
        let singles: Vec<Case> = cases.filter(|case| case.kind == Kind::Single).collect();
        for effect in socam_model::effects::CATALOGUE {
            assert!(singles.iter().any(|case| case.hidden[0].effect == effect.id), "{} {locked}", effect.id);
        }
    }
}

/// Every effect of a list at every place, as large as it gets.
fn each(ranges: &[sizes::Range]) -> Vec<Hidden> {
    let draw = &mut Draw::new(5, 0);
    let all = ranges.iter().flat_map(|(effect, places)| places.iter().map(move |place| (*effect, *place)));
    all.map(|(effect, (place, (least, most)))| {
        // The stiffer a shaft, and the later a sensor is cut off or a coupling slips, the less it shows.
        let inverse = matches!(effect, "missing_compliance" | "sensor_saturation" | "coupling_slip");
        sizes::hide(effect, place, if inverse { least } else { most }, draw)
    })
    .collect()
}

/// A bench without noise on which this is hidden, or nothing, and one recording of it.
fn recorded(hidden: Option<Hidden>, model: &str) -> Dataset {
    let mut case = Case::draw(1, 0).unwrap();
    let base = builtin(model).unwrap();
    case.model = model.into();
    case.parameters = base.parameters.iter().map(|known| (known.name.clone(), known.value)).collect();
    case.noise_std = Vec::new();
    case.hidden = hidden.into_iter().collect();
    case.bits = 16;
    let setup = crate::Setup { noisy: false, ..case.setup().unwrap() };
    let run = Run { profile: "multisine".into(), strength: 1.0, profile_seed: 1, noise_seed: 1 };
    run.record(&setup, "run").unwrap()
}

/// Largest change of a channel, as a part of its range.
fn change(a: &Dataset, b: &Dataset) -> f64 {
    let columns = |data: &Dataset| {
        let names: Vec<String> = data.channels().iter().map(socam_recording::Channel::column_name).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        data.load(&names)
            .unwrap()
            .columns
            .into_iter()
            .map(|column| column.values().to_vec())
            .collect::<Vec<_>>()
    };
    let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
    let each = columns(a).into_iter().zip(columns(b)).map(|(a, b)| {
        let range = largest(&mut a.iter().copied()).max(f64::MIN_POSITIVE);
        largest(&mut a.iter().zip(&b).map(|(a, b)| a - b)) / range
    });
    each.fold(0.0, f64::max)
}

#[test]
fn everything_that_can_be_hidden_runs_and_shows() {
    let all = each(&sizes::RANGES).into_iter().chain(each(&sizes::OUTSIDE));
    let plain = ["speed-o-cam", "two-mass"].map(|model| recorded(None, model));
    let mut unseen = Vec::new();
    for hidden in all {
        let two_mass = hidden.effect == "torque_ripple";
        let model = if two_mass { "two-mass" } else { "speed-o-cam" };
        let shown = change(&plain[usize::from(two_mass)], &recorded(Some(hidden.clone()), model));
        if shown <= 1e-3 {
            unseen.push(format!("{hidden:?}: {shown}"));
        }
    }
    assert!(unseen.is_empty(), "{}", unseen.join("\n"));
}

#[test]
fn what_a_diagnosis_gets_is_the_plain_model() {
    let case = Case::draw(1, 1).unwrap();
    assert!(!case.hidden.is_empty());
    assert_eq!(case.base().unwrap().text, builtin(&case.model).unwrap().text);
}
