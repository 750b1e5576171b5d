use super::*;
use crate::document::{AnswerNode, HeldOut, Level, ProofOutcome, Rival, Validation};

fn example() -> Diagnosis {
    serde_json::from_str(include_str!("example.json")).unwrap()
}

/// Effect, place and weight.
type Competing<'a> = (&'a str, &'a str, f64);

fn rivals(all: &[(&str, &str, f64)]) -> Vec<Rival> {
    let rival = |(effect, location, weight): &(&str, &str, f64)| Rival {
        effect: (*effect).into(),
        location: (*location).into(),
        weight: *weight,
    };
    all.iter().map(rival).collect()
}

/// The example with other competing explanations.
fn with_rivals(all: &[(&str, &str, f64)]) -> Diagnosis {
    let mut diagnosis = example();
    diagnosis.findings[0].rivals = rivals(all);
    diagnosis
}

fn nameless(location: &str) -> Finding {
    let finding = example().findings.remove(0);
    Finding {
        effect: UNEXPLAINED.into(),
        location: location.into(),
        parameters: Vec::new(),
        rivals: Vec::new(),
        formulas: Vec::new(),
        ..finding
    }
}

/// A headline in the form in which a terminal shows it.
fn lines(diagnosis: &Diagnosis) -> String {
    let headline = headline(diagnosis);
    let claims = headline.claims.iter().enumerate().map(|(index, claim)| match &claim.size {
        Some(size) => format!("{}. {}: {size}", index + 1, claim.what),
        None => format!("{}. {}", index + 1, claim.what),
    });
    let all = [format!("{:?}: {}", headline.tone, headline.title)]
        .into_iter()
        .chain(claims)
        .chain(headline.certainty);
    all.collect::<Vec<_>>().join("\n")
}

const TIED: &str = "\
Missing: Physics is missing: Coulomb friction, at either bearing (motor_bearing or load_bearing)
1. Coulomb friction, at either bearing (motor_bearing or load_bearing): torque 0.3010 N m (95 % interval 0.2951 to 0.3069), if at motor_bearing
Confirmed on held-out recordings: the corrected model predicts them better than the base model, and no channel worse.
These recordings do not tell its explanations apart (weights 51 % and 49 %).";

const ALONE: &str = "\
Missing: Physics is missing: Coulomb friction at motor_bearing
1. Coulomb friction at motor_bearing: torque 0.3010 N m (95 % interval 0.2951 to 0.3069)
Confirmed on held-out recordings: the corrected model predicts them better than the base model, and no channel worse.
No other explanation that was fitted comes close.";

const BESIDE: &str = "\
Missing: Physics is missing: Coulomb friction at motor_bearing
1. Coulomb friction at motor_bearing: torque 0.3010 N m (95 % interval 0.2951 to 0.3069)
Confirmed on held-out recordings: the corrected model predicts them better than the base model, and no channel worse.
Its weight among the explanations that were fitted is 79 %; next is Stribeck friction at motor_bearing with 21 %.";

const OPEN: &str = "\
Missing: Physics is missing: friction, drag or a loss at motor_bearing, fitted as Coulomb friction
1. friction, drag or a loss at motor_bearing, fitted as Coulomb friction: torque 0.3010 N m (95 % interval 0.2951 to 0.3069)
Confirmed on held-out recordings: the corrected model predicts them better than the base model, and no channel worse.
With a probability of 90 % it is friction, drag or a loss at motor_bearing, with 73 % Coulomb friction there.
Probabilities are how often such statements were true on simulated benches with a hidden effect; on other machines they may differ.";

const NOTHING: &str = "\
Adequate: Nothing is missing that these recordings could show
On data that were not fitted, the worst channel, output_speed, is missed by 3.3 times its noise floor.
A complete model is called incomplete in 1 % of diagnoses.";

const NAMELESS: &str = "\
Unexplained: Something is missing at coupling_3 that no effect of the catalogue explains
1. unexplained misfit at coupling_3
Not confirmed: nothing was held out. Models were compared with each recording left out in turn.
Something is left: on data that were not fitted, output_speed is still missed by 3.2 times its noise floor (3.3 before).";

const CUT_OFF: &str = "\
Unexplained: Not judged: the search was ended before anything was found
The search was ended after 45.0 s, to keep its budget of 60 s: no effect was looked for.
On data that were not fitted, the worst channel, output_speed, is missed by 3.3 times its noise floor.";

const CUT_OFF_LATER: &str = "\
Missing: Physics is missing: Coulomb friction at motor_bearing
1. Coulomb friction at motor_bearing: torque 0.3010 N m (95 % interval 0.2951 to 0.3069)
The search was ended after 45.0 s, to keep its budget of 60 s: no effect was looked for.
Confirmed on held-out recordings: the corrected model predicts them better than the base model, and no channel worse.
No other explanation that was fitted comes close.";

const CONTRADICTED: &str = "\
Contradicted: Contradicted by the held-out recordings: Coulomb friction at motor_bearing, and something without a name at load
1. Coulomb friction at motor_bearing: torque 0.3010 N m (95 % interval 0.2951 to 0.3069)
2. unexplained misfit at load
The proof failed.
Finding 1: no other explanation that was fitted comes close.";

const ORDINARY: &str = "\
Adequate: Nothing is missing but ordinary imperfections: Coulomb friction at motor_bearing
1. Coulomb friction at motor_bearing: torque 0.3010 N m (95 % interval 0.2951 to 0.3069)
Confirmed on held-out recordings: the corrected model predicts them better than the base model, and no channel worse.
Coulomb friction at motor_bearing is ordinary at this size and no fault: bearings rub.
No other explanation that was fitted comes close.";

#[test]
fn headlines_read_as_expected() {
    let mut adequate = example();
    (adequate.verdict, adequate.held_out) = (Verdict::Adequate, None);
    adequate.findings.clear();
    let cut_off = |diagnosis: &Diagnosis| {
        let sentence =
            "The search was ended after 45.0 s, to keep its budget of 60 s: no effect was looked for.";
        Diagnosis { finished: false, unfinished: Some(sentence.into()), ..diagnosis.clone() }
    };
    let nothing_yet = Diagnosis { verdict: Verdict::NotJudged, ..cut_off(&adequate) };
    let cut_off_later = cut_off(&with_rivals(&[]));
    let mut ordinary = with_rivals(&[]);
    ordinary.verdict = Verdict::Adequate;
    ordinary.findings[0].evidence.ordinary = Some("bearings rub".into());
    let mut unexplained = example();
    (unexplained.verdict, unexplained.validation, unexplained.held_out) =
        (Verdict::Unexplained, Validation::LeaveOneOut, None);
    unexplained.findings = vec![nameless("coupling_3")];
    unexplained.fit.channels[0].1.holdout_rms_after = Some(0.32);
    let mut contradicted = with_rivals(&[("mesh_loss", "mesh", 0.02)]);
    contradicted.held_out =
        Some(HeldOut { outcome: ProofOutcome::Failed, sentence: "The proof failed.".into() });
    contradicted.findings.push(nameless("load"));
    let mut open = with_rivals(&[]);
    let node = |node: &str, level, probability| AnswerNode {
        node: node.into(),
        level,
        probability,
        finding: Some(1),
    };
    open.answer = vec![node("friction@motor_bearing", Level::Family, 0.9)];
    let cases = [
        (example(), TIED),
        (with_rivals(&[]), ALONE),
        (with_rivals(&[("stribeck_friction", "motor_bearing", 0.21)]), BESIDE),
        (open, OPEN),
        (adequate, NOTHING),
        (ordinary, ORDINARY),
        (nothing_yet, CUT_OFF),
        (cut_off_later, CUT_OFF_LATER),
        (unexplained, NAMELESS),
        (contradicted, CONTRADICTED),
    ];
    for (diagnosis, expected) in cases {
        assert_eq!(lines(&diagnosis), expected);
    }
}

#[test]
fn every_kind_of_tie_has_its_words() {
    let cases: [(&[Competing<'_>], &str); 6] = [
        (
            &[("stribeck_friction", "motor_bearing", 0.5)],
            "Coulomb friction or Stribeck friction at motor_bearing",
        ),
        (
            &[
                ("coulomb_friction", "load_bearing", 0.26),
                ("stribeck_friction", "motor_bearing", 0.25),
                ("stribeck_friction", "load_bearing", 0.24),
            ],
            "Coulomb friction or Stribeck friction, at either bearing (motor_bearing or load_bearing)",
        ),
        (
            &[("coulomb_friction", "cam_bearing", 0.3), ("coulomb_friction", "load_bearing", 0.3)],
            "Coulomb friction, at one of 3 bearings (motor_bearing, cam_bearing or load_bearing)",
        ),
        (&[("mesh_loss", "mesh", 0.45)], "Coulomb friction at motor_bearing, or mesh loss at mesh"),
        // The same rival twice is one rival.
        (
            &[("mesh_loss", "mesh", 0.3), ("mesh_loss", "mesh", 0.3)],
            "Coulomb friction at motor_bearing, or mesh loss at mesh",
        ),
        // A weight below a third of the finding's own weight is not a tie.
        (&[("mesh_loss", "mesh", 0.2)], "Coulomb friction at motor_bearing"),
    ];
    for (rivals, expected) in cases {
        assert_eq!(headline(&with_rivals(rivals)).claims[0].what, expected);
    }
}

/// Of several findings the title names the law of each, and its claims the competing ones.
#[test]
fn a_title_of_several_findings_is_short() {
    let mut several = with_rivals(&[("stribeck_friction", "motor_bearing", 0.5)]);
    let mut other = several.findings[0].clone();
    (other.effect, other.location) = ("mesh_loss".into(), "mesh".into());
    other.rivals.clear();
    several.findings.push(other);
    let said = headline(&several);
    assert_eq!(
        said.title,
        "Physics is missing: Coulomb friction or a competing model at motor_bearing and mesh loss at mesh"
    );
    assert_eq!(said.claims[0].what, "Coulomb friction or Stribeck friction at motor_bearing");
    several.findings[0].rivals[0].location = "load_bearing".into();
    assert_eq!(
        headline(&several).title,
        "Physics is missing: (1) Coulomb friction at motor_bearing, or a competing model; (2) mesh loss at mesh"
    );
}

#[test]
fn a_size_that_is_not_determined_is_no_number() {
    let mut diagnosis = with_rivals(&[]);
    let own = &mut diagnosis.findings[0].parameters[0];
    (own.value, own.ci95) = (None, [Some(0.2), None]);
    assert_eq!(headline(&diagnosis).claims[0].size.as_deref(), Some("torque above 0.2000 N m"));
}

#[test]
fn places_of_findings_and_of_likely_rivals_are_marked() {
    let diagnosis = with_rivals(&[
        ("coulomb_friction", "load_bearing", 0.4),
        ("mesh_loss", "mesh", 0.01),
        ("stribeck_friction", "motor_bearing", 0.1),
    ]);
    assert_eq!(
        marks(&diagnosis),
        [("motor_bearing", PlaceMark::Finding(1)), ("load_bearing", PlaceMark::Rival)]
    );
}
