//! What became of each candidate: the stages note it here while the search runs, and the answer tells it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use socam_findings::words;

use crate::{
    candidate::Candidate,
    criterion::Difference,
    document::{CandidateFate, Stage},
    score_test::RankedCandidate,
};

/// What ended the way of a candidate in one step of the search.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Fate {
    /// The score test predicts an amplitude outside its bounds.
    Impossible,
    /// The score test's p-value is not below the false alarm rate.
    Insignificant { p_value: f64, rate: f64 },
    /// Others predicted larger gains.
    Behind { p_value: f64 },
    /// Its deviance did not keep up with the best one.
    RacedOut { iterations: usize, deviance: f64, best: f64 },
    /// Its fit overflowed, or stayed far from the data.
    Diverged,
    /// A parameter lies outside the support of its prior.
    ShutOut,
    /// Another candidate was chosen. `less` is its score less this one's.
    Worse { than: String, less: Difference },
    /// The best of its step, but it gained too little.
    NoGain(Difference),
    /// It gained no more than the discrepancy of the law of an earlier finding can make.
    Remainder,
    /// A curve without a law predicts better.
    Curve,
    /// Another law took its place.
    Replaced { by: String },
    /// The model without it predicts as well.
    Superfluous(Difference),
    /// Its amplitude is not determined.
    Undetermined,
    /// It is a finding.
    Found,
}

impl Fate {
    fn stage(&self) -> Stage {
        match self {
            Self::Impossible | Self::Insignificant { .. } | Self::Behind { .. } => Stage::NotProposed,
            Self::RacedOut { .. } | Self::Diverged => Stage::RacedOut,
            Self::ShutOut => Stage::ShutOut,
            Self::Worse { .. } | Self::NoGain(_) | Self::Remainder | Self::Curve => Stage::Worse,
            Self::Replaced { .. } | Self::Superfluous(_) | Self::Undetermined => Stage::Removed,
            Self::Found => Stage::Found,
        }
    }

    fn sentence(&self) -> String {
        let score = |Difference { log_score, std }: &Difference| {
            format!("log score {}, standard error {}", words::rough(*log_score), words::rough(*std))
        };
        match self {
            Self::Impossible => {
                "the score test predicts a size outside its bounds, such as a wrong sign".into()
            }
            Self::Insignificant { p_value, rate } => {
                format!("not significant in the score test (p = {p_value:.2}, limit {rate})")
            }
            Self::Behind { p_value } => format!(
                "the score test predicted larger gains of the others that were fitted (its own p-value {})",
                words::chance(Some(*p_value))
            ),
            Self::RacedOut { iterations, deviance, best } => format!(
                "given up after at most {iterations} iterations of its fit, at {} times the sum of squares that the best candidate left",
                words::rough(deviance / best)
            ),
            Self::Diverged => "its fit overflowed, or stayed far from the data".into(),
            Self::ShutOut => "its prior excludes the values at which its fit ended".into(),
            Self::Worse { than, less } if less.log_score > 0.0 => {
                format!("{than} predicts better ({})", score(less))
            }
            Self::Worse { than, less } => format!(
                "it predicts no worse than {than} ({}), which has fewer parameters or more plausible values",
                score(less)
            ),
            Self::NoGain(gain) => {
                format!("the best of its step, but it gains no more than a standard error ({})", score(gain))
            }
            Self::Remainder => "it gains no more than the law of an earlier finding can be wrong by".into(),
            Self::Curve => "a curve without a law predicts better".into(),
            Self::Replaced { by } => format!("found, then replaced by {by}"),
            Self::Superfluous(gain) => {
                format!("found, then removed: without it the model predicts as well ({})", score(gain))
            }
            Self::Undetermined => "found, then removed: the recordings do not determine its size".into(),
            Self::Found => "found".into(),
        }
    }
}

/// A note about a candidate.
#[derive(Debug, Clone)]
struct Note {
    effect: &'static str,
    place: String,
    step: usize,
    data: &'static str,
    fate: Fate,
}

#[derive(Debug)]
struct State {
    step: usize,
    notes: Vec<Note>,
}

impl Default for State {
    fn default() -> Self {
        Self { step: 1, notes: Vec::new() }
    }
}

/// The notes of one diagnosis. Clones share them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Journal {
    state: Arc<Mutex<State>>,
    /// On what the candidates are fitted, where it is not whole recordings.
    data: &'static str,
}

impl Journal {
    /// The same journal, for notes about fits to other data.
    pub(crate) fn on(&self, data: &'static str) -> Self {
        Self { data, ..self.clone() }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a step of the search: from now on notes are about it.
    pub(crate) fn begin_step(&self, step: usize) {
        self.state().step = step;
    }

    pub(crate) fn note(&self, candidate: &Candidate, fate: Fate) {
        let mut state = self.state();
        let (effect, place) = (candidate.effect.id, candidate.place.clone());
        let note = Note { effect, place, step: state.step, data: self.data, fate };
        state.notes.push(note);
    }

    /// Notes why candidates of a score test are not among `tried`.
    pub(crate) fn note_left_out(&self, tests: &[RankedCandidate], tried: &[(Candidate, f64)], rate: f64) {
        let is_tried = |one: &Candidate| tried.iter().any(|(known, _)| known.is_same(one));
        for (index, one) in tests.iter().enumerate().filter(|(_, one)| !is_tried(&one.start)) {
            let same = |other: &&RankedCandidate| other.start.is_same(&one.start);
            if tests[..index].iter().any(|other| same(&other)) {
                continue;
            }
            let possible = tests[index..].iter().filter(same).filter(|other| other.possible);
            let p_value = possible.map(|other| other.p_value).reduce(f64::min);
            let fate = match p_value {
                None => Fate::Impossible,
                Some(p_value) if p_value >= rate => Fate::Insignificant { p_value, rate },
                Some(p_value) => Fate::Behind { p_value },
            };
            self.note(&one.start, fate);
        }
    }

    /// Effects and places of which this step gave up a fit, and which came no further.
    pub(crate) fn given_up(&self) -> Vec<(&'static str, String)> {
        let state = self.state();
        let own = || state.notes.iter().filter(|note| note.step == state.step && note.data.is_empty());
        let came_further = |one: &Note| {
            own().any(|note| {
                note.effect == one.effect && note.place == one.place && note.fate.stage() > Stage::RacedOut
            })
        };
        own()
            .filter(|note| note.fate.stage() == Stage::RacedOut && !came_further(note))
            .map(|note| (note.effect, note.place.clone()))
            .collect()
    }

    /// How far each effect came at each place: of notes at the same stage, the last.
    pub(crate) fn fates(&self) -> Vec<CandidateFate> {
        let state = self.state();
        let mut all: Vec<CandidateFate> = Vec::new();
        for note in &state.notes {
            let stage = note.fate.stage();
            let known = all.iter_mut().find(|one| one.effect == note.effect && one.location == note.place);
            let data = if note.data.is_empty() { String::new() } else { format!("{}: ", note.data) };
            let sentence = words::capital(&format!("{data}{}", note.fate.sentence()));
            let one = CandidateFate::new(note.effect, &note.place, (stage, note.step), sentence);
            match known {
                Some(known) if known.stage > stage => {}
                Some(known) => *known = one,
                None => all.push(one),
            }
        }
        all
    }
}

/// A candidate in words.
pub(crate) fn named(candidate: &Candidate) -> String {
    format!("{} at {}", words::effect(candidate.effect.id), candidate.place)
}

#[cfg(test)]
mod tests {
    use socam_model::effects;

    use super::*;

    #[test]
    fn given_up_are_candidates_that_came_no_further_in_this_step() {
        let friction = effects::find("coulomb_friction").unwrap();
        let one = |place: &str| Candidate::new(friction, place, vec![("torque", 0.1)]);
        let journal = Journal::default();
        journal.note(&one("motor"), Fate::Diverged);
        journal.begin_step(2);
        let raced_out = Fate::RacedOut { iterations: 9, deviance: 24.0, best: 10.0 };
        journal.note(&one("load"), raced_out.clone());
        journal.note(&one("cam"), raced_out.clone());
        journal.note(&one("cam"), Fate::ShutOut);
        journal.on("on short parts").note(&one("wheel"), raced_out);
        assert_eq!(journal.given_up(), [("coulomb_friction", "load".to_owned())]);
    }

    #[test]
    fn the_furthest_note_of_each_candidate_is_told() {
        let friction = effects::find("coulomb_friction").unwrap();
        let one = |place: &str| Candidate::new(friction, place, vec![("torque", 0.1)]);
        let (journal, gain) = (Journal::default(), Difference { log_score: 3.0, std: 5.0 });
        journal.begin_step(1);
        journal.note(&one("motor"), Fate::RacedOut { iterations: 9, deviance: 24.0, best: 10.0 });
        journal.on("on short parts").note(&one("load"), Fate::ShutOut);
        journal.begin_step(2);
        journal.note(&one("motor"), Fate::NoGain(gain));
        journal.note(&one("motor"), Fate::Insignificant { p_value: 0.3, rate: 0.01 });
        let told: Vec<_> = journal
            .fates()
            .into_iter()
            .map(|fate| (fate.location, fate.stage, fate.step, fate.sentence))
            .collect();
        let worse = "The best of its step, but it gains no more than a standard error (log score 3.0, standard error 5.0)";
        let shut_out = "On short parts: its prior excludes the values at which its fit ended";
        let expected = [("motor", Stage::Worse, 2, worse), ("load", Stage::ShutOut, 1, shut_out)];
        assert_eq!(told, expected.map(|(place, stage, step, text)| (place.into(), stage, step, text.into())));
    }
}
