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
