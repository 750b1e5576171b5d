//! The rates of all cases, for people and as a document.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;
use socam_sim::challenge::Kind;

use super::rates::{Rate, lower_by_chance, lower_by_chance_exactly};
use super::score::Score;
use crate::table;

const SCHEMA: &str = "socam.challenge/1";

/// Nothing named.
const NOTHING: &str = "nothing";

/// What is printed. The names are part of the JSON document.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    schema: &'static str,
    seed: u64,
    kinds: Vec<KindReport>,
    /// True effect -> what was named first -> cases, of those with one effect that can be detected.
    confusion: BTreeMap<String, BTreeMap<String, usize>>,
    /// Right answers after whose correction all channels are predicted down to 1.15 times their noise, of benches that hide effects
    /// of the catalogue; of the others, most of which are called unexplained, nothing is corrected.
    at_the_floor: Rate,
    at_the_floor_outside: Rate,
    /// Intervals of effects' parameters that hold the truth.
    intervals: Rate,
    /// Per diagnosis, s.
    cpu_s: Option<Spread>,
    cases: Vec<Score>,
}

#[derive(Debug, Serialize)]
struct KindReport {
    kind: Kind,
    cases: usize,
    detectable: usize,
    /// Of those that can be detected; of clean benches, of all: no false alarm.
    right: Rate,
    right_open: Rate,
    right_locked: Rate,
    /// Chance that the locked ones score so low by chance; `None` where either half is empty.
    locked_lower_p_value: Option<f64>,
    /// The same by Fisher's exact test.
    locked_lower_exact_p_value: Option<f64>,
    /// Of all, for where nothing can be detected a name is wrong all the more.
    wrong_name: Rate,
    failed: usize,
}

#[derive(Debug, Serialize)]
struct Spread {
    median: f64,
    largest: f64,
}

const KINDS: [(Kind, &str); 4] = [
    (Kind::Single, "one effect"),
    (Kind::Double, "two effects"),
    (Kind::Outside, "not in the catalogue"),
    (Kind::Clean, "nothing hidden"),
];

impl Report {
    pub(super) fn new(seed: u64, cases: Vec<Score>) -> Self {
        let singles = cases.iter().filter(|score| score.kind == Kind::Single && score.detectable);
        let mut confusion: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
        for score in singles {
            *confusion.entry(score.hidden[0].effect.clone()).or_default().entry(first(score)).or_default() +=
                1;
        }
        Self {
            schema: SCHEMA,
            seed,
            kinds: KINDS.iter().map(|(kind, _)| KindReport::new(*kind, &cases)).collect(),
            confusion,
            at_the_floor: at_the_floor(&cases, &[Kind::Single, Kind::Double]),
            at_the_floor_outside: at_the_floor(&cases, &[Kind::Outside]),
            intervals: Rate::of(
                cases.iter().flat_map(|score| score.intervals.iter().map(|(_, holds)| *holds)),
            ),
            cpu_s: spread(&cases),
            cases,
        }
    }

    pub(super) fn text(&self) -> String {
        let mut text = format!("challenge, seed {}, {} cases\n\n", self.seed, self.cases.len());
        let head = ["", "cases", "detectable", "right", "open", "locked", "wrong name"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(self.kinds.iter().zip(KINDS).map(|(kind, (_, name))| kind.row(name)));
        text += &table::align(&rows, &[false, true, true, true, true, true, true]);
        for (kind, (_, name)) in self.kinds.iter().zip(KINDS) {
            if let Some((p_value, exact)) = kind.locked_lower_p_value.zip(kind.locked_lower_exact_p_value) {
                let lower = if p_value < 0.05 { "lower" } else { "no lower" };
                let _ = writeln!(
                    text,
                    "  {name}: locked cases score {lower} than open ones (p = {p_value:.3}; exactly {exact:.3})"
                );
            }
            if kind.failed > 0 {
                let _ = writeln!(text, "  {name}: {} diagnoses failed", kind.failed);
            }
        }
        text += "\nwhat one effect was taken for, where it can be detected\n";
        for (truth, named) in &self.confusion {
            let mut all: Vec<_> = named.iter().collect();
            all.sort_by_key(|(name, cases)| (std::cmp::Reverse(**cases), (*name).clone()));
            let all: Vec<String> = all.iter().map(|(name, cases)| format!("{name} {cases}")).collect();
            let _ = writeln!(text, "  {truth:<22}{}", all.join(", "));
        }
        let _ = writeln!(
            text,
            "\nheld-out residuals within 1.15 times the noise after a right answer: {}; outside the catalogue {}",
            self.at_the_floor.text(),
            self.at_the_floor_outside.text()
        );
        let _ =
            writeln!(text, "intervals of effects' parameters that hold the truth: {}", self.intervals.text());
        if let Some(Spread { median, largest }) = self.cpu_s {
            let _ = writeln!(text, "processor time of a diagnosis: {median:.1} s, at most {largest:.1} s");
        }
        text + &self.misses()
    }

    /// One line for each open case that went wrong; those of locked ones stay closed.
    fn misses(&self) -> String {
        let wrong = |score: &&Score| !score.right && !score.locked && score.detectable;
        let mut text = String::new();
        for score in self.cases.iter().filter(wrong) {
            let hidden: Vec<String> =
                score.hidden.iter().map(|hidden| format!("{}@{}", hidden.effect, hidden.place)).collect();
            let named: Vec<String> =
                score.named.iter().map(|(effect, location)| format!("{effect}@{location}")).collect();
            let or_nothing =
                |list: Vec<String>| if list.is_empty() { NOTHING.into() } else { list.join(" + ") };
            let gains: Vec<String> = score
                .oracle_gain
                .iter()
                .map(|gain| gain.map_or("?".into(), |gain| format!("{gain:.0}")))
                .collect();
            let named =
                score.error.clone().map_or_else(|| or_nothing(named), |error| format!("failed: {error}"));
            let gains =
                if gains.is_empty() { String::new() } else { format!(" (gain {})", gains.join(", ")) };
            let _ =
                writeln!(text, "  case {}: {}{gains} was called {named}", score.number, or_nothing(hidden));
        }
        if text.is_empty() { text } else { format!("\nopen cases that went wrong\n{text}") }
    }
}

impl KindReport {
    fn new(kind: Kind, cases: &[Score]) -> Self {
        let of_kind = || cases.iter().filter(move |score| score.kind == kind);
        // Where nothing is hidden there is nothing to be detected.
        let counted = || of_kind().filter(|score| score.detectable);
        let half = |locked: bool| {
            Rate::of(counted().filter(|score| score.locked == locked).map(|score| score.right))
        };
        let (right_open, right_locked) = (half(false), half(true));
        Self {
            kind,
            cases: of_kind().count(),
            detectable: counted().count(),
            right: Rate::of(counted().map(|score| score.right)),
            locked_lower_p_value: lower_by_chance(&right_open, &right_locked),
            locked_lower_exact_p_value: lower_by_chance_exactly(&right_open, &right_locked),
            right_open,
            right_locked,
            wrong_name: Rate::of(of_kind().map(|score| score.wrong_name)),
            failed: of_kind().filter(|score| score.error.is_some()).count(),
        }
    }

    fn row(&self, name: &str) -> Vec<String> {
        let percent = |rate: &Rate| rate.percent.map_or("-".into(), |percent| format!("{percent:.1} %"));
        let cells = [
            self.cases.to_string(),
            self.detectable.to_string(),
            self.right.text(),
            percent(&self.right_open),
            percent(&self.right_locked),
            self.wrong_name.text(),
        ];
        std::iter::once(name.to_owned()).chain(cells).collect()
    }
}

/// What was named first: the effect, and the place where that alone is wrong.
fn first(score: &Score) -> String {
    let Some((effect, location)) = score.named.first() else {
        return if score.error.is_some() { "failed".into() } else { NOTHING.into() };
    };
    let elsewhere =
        score.hidden.first().is_some_and(|hidden| hidden.effect == *effect && hidden.place != *location);
    if elsewhere { format!("{effect} elsewhere") } else { effect.clone() }
}

fn at_the_floor(cases: &[Score], kinds: &[Kind]) -> Rate {
    Rate::of(cases.iter().filter(|score| kinds.contains(&score.kind)).filter_map(|score| score.at_the_floor))
}

fn spread(cases: &[Score]) -> Option<Spread> {
    let mut times: Vec<f64> = cases.iter().filter_map(|score| score.cpu_s).collect();
    times.sort_by(f64::total_cmp);
    Some(Spread { median: *times.get(times.len() / 2)?, largest: *times.last()? })
}
