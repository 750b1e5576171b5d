//! The shortlist: which ranked candidates are fitted, and from which starts.

use crate::{
    candidate::Candidate,
    candidates,
    context::FAR_BEYOND_NOISE,
    nonparametric::term::Unexplained,
    selection::{DISPLACED, Path},
};

/// Largest number of starts that are fitted, and of places of one effect among them: in a long chain neighbouring places score alike.
const TRIED: usize = 8;
const PLACES: usize = 4;
/// Largest number of neighbours of the best one that are fitted besides.
const NEIGHBOURS: usize = 6;
/// Largest number of effects that are tried with large starts where the base model is far from the data.
const LARGE: usize = 12;

impl Path {
    /// Starts of the significant candidates with the largest gains, with their p-values.
    pub(crate) fn worth_trying(&self, false_alarm_rate: f64) -> Vec<(Candidate, f64)> {
        let mut tried: Vec<(Candidate, f64)> = Vec::new();
        let able = self.tests.iter().filter(|one| one.possible && one.p_value < false_alarm_rate);
        for one in able {
            let starts = tried.iter().filter(|(candidate, _)| candidate.is_same(&one.start)).count();
            let elsewhere = tried.iter().filter(|(candidate, _)| candidate.effect.id == one.start.effect.id);
            let elsewhere = elsewhere.filter(|(candidate, _)| !candidate.is_same(&one.start)).count();
            let has_room = tried.len() < TRIED && elsewhere < PLACES && !one.start.is_always_tried();
            if starts < one.start.most_starts() && has_room {
                tried.push((one.start.clone(), one.p_value));
            }
        }
        self.small_starts(tried).chain(self.large_starts(false_alarm_rate)).collect()
    }

    /// Starts of the significant candidates that share a candidate's place, or its law or a law of one kind with it, and are not among `tried`,
    /// with their p-values.
    pub(crate) fn neighbours(
        &self,
        of: &Candidate,
        tried: &[(Candidate, f64)],
        false_alarm_rate: f64,
    ) -> Vec<(Candidate, f64)> {
        let mut all: Vec<(Candidate, f64)> = Vec::new();
        for one in self.tests.iter().filter(|one| one.possible && one.p_value < false_alarm_rate) {
            let is_near = one.start.place == of.place || one.start.is_akin(of);
            let is_known = tried.iter().chain(&all).any(|(known, _)| known.is_same(&one.start));
            if is_near && !is_known && !one.start.is_always_tried() && all.len() < NEIGHBOURS {
                all.push((one.start.clone(), one.p_value));
            }
        }
        self.small_starts(all).collect()
    }

    /// Start points of candidates' fits, with their p-values.
    fn small_starts(&self, all: Vec<(Candidate, f64)>) -> impl Iterator<Item = (Candidate, f64)> {
        let (model, values) = (&self.last.model, &self.last.at.values);
        all.into_iter().flat_map(|(candidate, p_value)| {
            let starts = candidates::starts(candidate, model, values);
            starts.into_iter().map(move |start| (start, p_value))
        })
    }

    /// Starts at usual amplitudes of the candidates with the largest gains, significant or not: far from the data, fits from a small
    /// amplitude fail and scores are unreliable. Empty if the model is near the data.
    pub(crate) fn far_starts(&self) -> Vec<(Candidate, f64)> {
        // Added effects have brought the base parameters nearer to the truth.
        let displaced = if self.terms.is_empty() { DISPLACED } else { FAR_BEYOND_NOISE };
        if self.noise.excess() <= displaced {
            return Vec::new();
        }
        let mut known: Vec<&Candidate> = Vec::new();
        let mut far = Vec::new();
        for one in &self.tests {
            let starts = candidates::usual_starts(&one.start, &self.priors.rig);
            let is_new = !known.iter().any(|known| known.is_same(&one.start));
            if is_new && known.len() < LARGE && !starts.is_empty() && !one.start.is_always_tried() {
                known.push(&one.start);
                far.extend(starts.into_iter().map(|start| (start, one.p_value)));
            }
        }
        far
    }

    /// Small and large starts of the candidates that are always tried, where any other candidate is significant.
    fn large_starts(&self, false_alarm_rate: f64) -> Vec<(Candidate, f64)> {
        let others = self.tests.iter().filter(|one| !one.start.is_always_tried() && one.possible);
        let p_value = others.map(|one| one.p_value).fold(1.0, f64::min);
        if p_value >= false_alarm_rate {
            return Vec::new();
        }
        let all = self.tests.iter().filter(|one| one.start.is_always_tried());
        let starts = all.flat_map(|one| {
            let small = Some(one.start.clone()).filter(|_| one.possible);
            small.into_iter().chain(candidates::large_starts(&one.start, &self.priors.rig))
        });
        starts.map(|start| (start, p_value)).collect()
    }

    /// Candidates at the place of a nonparametric term that were not tried yet: their score at the null amplitude may say little about a
    /// large amplitude.
    pub(crate) fn overlooked(
        &self,
        curve: &Unexplained,
        tried: &[(Candidate, f64)],
    ) -> Vec<(Candidate, f64)> {
        let mut all: Vec<(Candidate, f64)> = Vec::new();
        for one in self.tests.iter().filter(|one| one.possible && one.start.place == curve.place) {
            if !tried.iter().chain(&all).any(|(known, _)| known.is_same(&one.start)) {
                all.push((one.start.clone(), curve.p_value));
            }
        }
        all
    }
}
