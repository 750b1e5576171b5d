//! What a search that was ended before its own end did not examine, in words.

use socam_findings::words;
use socam_identify::Cutoff;

use crate::selection::Unexamined;

/// A sentence: when and by what the search was ended, and what was not examined.
pub(super) fn sentence(how: Cutoff, rest: &Unexamined, is_any_found: bool) -> String {
    let rest = match rest {
        Unexamined::Candidates if is_any_found => "no further effect was tried to its end".into(),
        Unexamined::Candidates => "no effect was tried to its end".into(),
        Unexamined::Fits(all) => fits(all),
        Unexamined::Curves => "no curve without a law was tried".into(),
        Unexamined::Laws => "no law was fitted in the place of the curve".into(),
        Unexamined::Comparisons => "what is predicted without each finding was not fitted to its end".into(),
    };
    words::capital(&format!("{how}: {rest}."))
}

fn fits(all: &[(&str, String)]) -> String {
    let mut places: Vec<&str> = all.iter().map(|(_, place)| place.as_str()).collect();
    places.sort_unstable();
    places.dedup();
    let (number, at) = (counted(all.len(), "candidate"), counted(places.len(), "place"));
    let were = if all.len() == 1 { "was" } else { "were" };
    let first = all.first().map(|(effect, place)| {
        format!(
            "; the score test, which ranks them without a fit, has {} at {place} first",
            words::effect(effect)
        )
    });
    format!("{number} at {at} {were} not fitted to the end{}", first.unwrap_or_default())
}

/// `1 place`, `7 places`.
fn counted(number: usize, what: &str) -> String {
    if number == 1 { format!("1 {what}") } else { format!("{number} {what}s") }
}

#[cfg(test)]
mod tests {
    use socam_identify::Cause;

    use super::*;

    #[test]
    fn what_was_not_examined_is_a_sentence() {
        let how = Cutoff { cause: Cause::Budget, after_s: 45.0, budget_s: Some(60.0) };
        let head = "The search was ended after 45.0 s, to keep its budget of 60 s";
        let fits = [("coulomb_friction", "guide"), ("stribeck_friction", "guide"), ("backlash", "gear")];
        let fits: Vec<(&str, String)> = fits.map(|(effect, place)| (effect, place.to_owned())).into();
        let cases = [
            (Unexamined::Candidates, false, "no effect was tried to its end"),
            (Unexamined::Candidates, true, "no further effect was tried to its end"),
            (
                Unexamined::Fits(fits.clone()),
                false,
                "3 candidates at 2 places were not fitted to the end; the score test, which ranks them without a fit, has Coulomb friction at guide first",
            ),
            (Unexamined::Fits(Vec::new()), false, "0 candidates at 0 places were not fitted to the end"),
            (Unexamined::Curves, false, "no curve without a law was tried"),
        ];
        for (rest, is_any_found, expected) in cases {
            assert_eq!(sentence(how, &rest, is_any_found), format!("{head}: {expected}."));
        }
        let one = sentence(how, &Unexamined::Fits(fits[..1].to_vec()), false);
        assert!(one.contains("1 candidate at 1 place was not fitted"), "{one}");
    }
}
