//! The rates of all cases, clean and realistic ones separately, as text and as a document.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;
use socam_diagnose::document::CandidateFate;
use socam_sim::challenge::CaseKind;

use super::answer::{Answers, Held};
use super::oracle::DETECTABLE_GAIN;
use super::probability::{Bin, calibration, log_score};
use super::rates::{Rate, as_many_by_chance};
use super::score::Score;
use crate::table;

const SCHEMA: &str = "socam.challenge/2";

/// Word for no finding.
const NOTHING: &str = "nothing";

/// The report. The names are part of the JSON document.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    schema: &'static str,
    seed: u64,
    clean: Part,
    realistic: Part,
    cases: Vec<Score>,
}

/// Cases without a background, or with one.
#[derive(Debug, Serialize)]
struct Part {
    cases: usize,
    kinds: Vec<KindReport>,
    /// Correct answers by family, of detectable cases.
    families: BTreeMap<String, Rate>,
    /// Confusion matrix: true effect -> first finding -> number of cases with one detectable effect.
    confusion: BTreeMap<String, BTreeMap<String, usize>>,
    false_alarms: FalseAlarms,
    /// Coverage of the intervals of effects' parameters.
    intervals: Rate,
    /// Mean natural logarithm of the probability of the hidden effects, and their number; of detectable effects.
    log_score: Option<f64>,
    log_score_of: usize,
    /// Where wrong answers lost the hidden effects: stage -> number of detectable effects.
    lost: BTreeMap<&'static str, usize>,
    /// Rate of wrong answers whose hidden effects, put in by hand, predict the held-out recordings better than the answer does, among those
    /// that can be compared. The others were lost by the criterion or by the model of the bench, not by the search.
    truth_is_better: Rate,
    /// The answers' nodes, of detectable cases that hide something.
    answers: Answers,
    /// Calibration of the stated probabilities.
    calibration: Vec<Bin>,
    /// Rate of correct answers whose corrected model predicts all channels within 1.15 times their noise, among benches that hide
    /// effects of the catalogue.
    at_the_floor: Rate,
}

#[derive(Debug, Serialize)]
struct FalseAlarms {
    /// False alarms: benches with nothing hidden on which something is found.
    any: Rate,
    /// False alarms, except findings that belong to the background of the bench.
    beside_background: Rate,
    /// Greatest false alarm rate that the diagnoses state.
    stated_rate: Option<f64>,
    /// p-value of `beside_background` at the stated rate.
    p_value: Option<f64>,
}

#[derive(Debug, Serialize)]
struct KindReport {
    kind: CaseKind,
    cases: usize,
    detectable: usize,
    /// Rate of correct answers among cases that can be detected; for benches with nothing hidden, the rate of cases without a false
    /// alarm.
    right: Rate,
    /// Rate of wrong names among all cases, including those in which nothing can be detected.
    wrong_name: Rate,
    failed: usize,
    /// Processor time of a diagnosis, s.
    cpu_s: Option<Spread>,
}

#[derive(Debug, Serialize)]
struct Spread {
    median: f64,
    largest: f64,
}

const KINDS: [(CaseKind, &str); 4] = [
    (CaseKind::Single, "one effect"),
    (CaseKind::Double, "two effects"),
    (CaseKind::Outside, "not in the catalogue"),
    (CaseKind::Clean, "nothing hidden"),
];

impl Report {
    pub(super) fn new(seed: u64, cases: Vec<Score>) -> Self {
        let part = |realistic: bool| {
            let own: Vec<&Score> = cases.iter().filter(|score| score.realistic == realistic).collect();
            Part::new(&own)
        };
        Self { schema: SCHEMA, seed, clean: part(false), realistic: part(true), cases }
    }

    pub(super) fn text(&self) -> String {
        let mut text = format!("challenge, seed {}, {} cases\n", self.seed, self.cases.len());
        for (name, part) in [
            ("clean benches", &self.clean),
            ("realistic benches (each with a background that no case names)", &self.realistic),
        ] {
            if part.cases > 0 {
                let _ = write!(text, "\n{name}\n{}", part.text());
            }
        }
        text + &self.misses()
    }

    /// One line for each wrong answer.
    fn misses(&self) -> String {
        let wrong = |score: &&Score| !score.right && (score.detectable || score.error.is_some());
        let mut text = String::new();
        for score in self.cases.iter().filter(wrong) {
            let hidden =
                score.hidden.iter().map(|hidden| format!("{}@{}", hidden.effect, hidden.place)).collect();
            let named = score.named.iter().map(|(effect, location)| format!("{effect}@{location}")).collect();
            let gain = |gain: &Option<f64>| gain.map_or("?".into(), |gain| format!("{gain:.0}"));
            let gains: Vec<String> = score.oracle_gain.iter().map(gain).collect();
            let named =
                score.error.clone().map_or_else(|| or_nothing(named), |error| format!("failed: {error}"));
            let gains =
                if gains.is_empty() { String::new() } else { format!(" (gain {})", gains.join(", ")) };
            let background = if score.realistic { "realistic" } else { "clean" };
            let _ = writeln!(
                text,
                "  case {} ({}, {background}): {}{gains} was called {named}",
                score.number,
                score.family,
                or_nothing(hidden)
            );
            for CandidateFate { effect, location, stage, sentence, .. } in &score.lost {
                let _ = writeln!(text, "    {effect}@{location}: {}. {sentence}", stage.words());
            }
            if let Some(gain) = score.truth_gains {
                let _ = writeln!(
                    text,
                    "    put in by hand, the truth gains {gain:.0} over the answer on the held-out recordings"
                );
            }
        }
        if text.is_empty() { text } else { format!("\ncases that went wrong\n{text}") }
    }
}

fn or_nothing(list: Vec<String>) -> String {
    if list.is_empty() { NOTHING.into() } else { list.join(" + ") }
}

impl Part {
    fn new(cases: &[&Score]) -> Self {
        let named = |score: &&&Score| matches!(score.kind, CaseKind::Single | CaseKind::Double);
        let detectable: Vec<&Score> = cases.iter().filter(|score| score.detectable).copied().collect();
        let mut families: BTreeMap<String, Vec<bool>> = BTreeMap::new();
        let mut confusion: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
        for score in &detectable {
            families.entry(score.family.clone()).or_default().push(score.right);
            if score.kind == CaseKind::Single {
                let effect = confusion.entry(score.hidden[0].effect.clone()).or_default();
                *effect.entry(first(score)).or_default() += 1;
            }
        }
        let probabilities: Vec<f64> =
            detectable.iter().flat_map(|score| score.probability.iter().copied()).collect();
        let hides = detectable.iter().filter(|score| !score.hidden.is_empty() && score.error.is_none());
        let hiding: Vec<&Held> = hides.map(|score| &score.held).collect();
        let floor = cases.iter().filter(named).filter_map(|score| score.at_the_floor);
        Self {
            cases: cases.len(),
            kinds: KINDS.iter().map(|(kind, _)| KindReport::new(*kind, cases)).collect(),
            families: families.into_iter().map(|(name, right)| (name, Rate::of(right))).collect(),
            confusion,
            false_alarms: FalseAlarms::new(cases),
            intervals: Rate::of(
                cases.iter().flat_map(|score| score.intervals.iter().map(|(_, holds)| *holds)),
            ),
            log_score: log_score(&probabilities),
            log_score_of: probabilities.len(),
            lost: lost(&detectable),
            truth_is_better: Rate::of(
                detectable.iter().filter_map(|score| score.truth_gains).map(|gain| gain > DETECTABLE_GAIN),
            ),
            answers: Answers::new(&hiding),
            calibration: calibration(cases.iter().flat_map(|score| score.statements.iter().copied())),
            at_the_floor: Rate::of(floor),
        }
    }

    fn text(&self) -> String {
        let head = ["", "cases", "detectable", "right", "wrong name", "CPU s (median, most)"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(self.kinds.iter().zip(KINDS).map(|(kind, (_, name))| kind.row(name)));
        let mut text = table::align(&rows, &[false, true, true, true, true, true]);
        for (kind, (_, name)) in self.kinds.iter().zip(KINDS).filter(|(kind, _)| kind.failed > 0) {
            let _ = writeln!(text, "  {name}: {} diagnoses failed", kind.failed);
        }
        text += &self.false_alarms.text();
        let _ =
            writeln!(text, "intervals of effects' parameters that hold the truth: {}", self.intervals.text());
        let _ = writeln!(
            text,
            "held-out residuals within 1.15 times the noise after a right answer: {}",
            self.at_the_floor.text()
        );
        if let Some(score) = self.log_score {
            let _ = writeln!(
                text,
                "probability given to the truth: mean logarithm {score:.3} over {} hidden effects",
                self.log_score_of
            );
        }
        for (stage, effects) in &self.lost {
            let _ = writeln!(text, "hidden effects of wrong answers, {stage}: {effects}");
        }
        if self.truth_is_better.of > 0 {
            let _ = writeln!(
                text,
                "wrong answers than which the hidden effects, put in by hand, predict better: {}",
                self.truth_is_better.text()
            );
        }
        text += &self.answers.text();
        text += &Bin::table(&self.calibration);
        text += "right by family\n";
        for (family, rate) in &self.families {
            let _ = writeln!(text, "  {family:<22}{}", rate.text());
        }
        text += "what one effect was taken for, where it can be detected\n";
        for (truth, named) in &self.confusion {
            let mut all: Vec<_> = named.iter().collect();
            all.sort_by_key(|(name, cases)| (std::cmp::Reverse(**cases), (*name).clone()));
            let all: Vec<String> = all.iter().map(|(name, cases)| format!("{name} {cases}")).collect();
            let _ = writeln!(text, "  {truth:<22}{}", all.join(", "));
        }
        text
    }
}

/// Number of hidden effects of wrong answers by the stage at which the search lost them.
fn lost(cases: &[&Score]) -> BTreeMap<&'static str, usize> {
    let mut all = BTreeMap::new();
    for lost in cases.iter().flat_map(|score| &score.lost) {
        *all.entry(lost.stage.words()).or_default() += 1;
    }
    all
}

impl FalseAlarms {
    fn new(cases: &[&Score]) -> Self {
        let empty = || cases.iter().filter(|score| score.kind == CaseKind::Clean && score.error.is_none());
        let any = Rate::of(empty().map(|score| !score.named.is_empty()));
        let beside_background = Rate::of(empty().map(|score| score.named.len() > score.background_named));
        let stated_rate = empty().filter_map(|score| score.stated_false_alarm_rate).reduce(f64::max);
        let p_value = stated_rate.and_then(|stated| as_many_by_chance(&beside_background, stated));
        Self { any, beside_background, stated_rate, p_value }
    }

    fn text(&self) -> String {
        let Some((stated, p_value)) = self.stated_rate.zip(self.p_value) else { return String::new() };
        let holds = if p_value < 0.05 { "more than" } else { "no more than" };
        format!(
            "false alarms: {} name something, {} something that is not of the background: {holds} the stated {:.2} % (p = {p_value:.3})\n",
            self.any.text(),
            self.beside_background.text(),
            100.0 * stated
        )
    }
}

impl KindReport {
    fn new(kind: CaseKind, cases: &[&Score]) -> Self {
        let of_kind = || cases.iter().filter(move |score| score.kind == kind);
        // A bench with nothing hidden has nothing to detect.
        let counted = || of_kind().filter(|score| score.detectable);
        let mut times: Vec<f64> = of_kind().filter_map(|score| score.cpu_s).collect();
        times.sort_by(f64::total_cmp);
        let median = times.get(times.len() / 2).copied();
        Self {
            kind,
            cases: of_kind().count(),
            detectable: counted().count(),
            right: Rate::of(counted().map(|score| score.right)),
            wrong_name: Rate::of(of_kind().map(|score| score.wrong_name)),
            failed: of_kind().filter(|score| score.error.is_some()).count(),
            cpu_s: median.zip(times.last()).map(|(median, largest)| Spread { median, largest: *largest }),
        }
    }

    fn row(&self, name: &str) -> Vec<String> {
        let times = |times: &Spread| format!("{:.1}, {:.1}", times.median, times.largest);
        let cells = [
            self.cases.to_string(),
            self.detectable.to_string(),
            self.right.text(),
            self.wrong_name.text(),
            self.cpu_s.as_ref().map_or("-".into(), times),
        ];
        std::iter::once(name.to_owned()).chain(cells).collect()
    }
}

/// The first finding: its effect, with the place if only that is wrong.
fn first(score: &Score) -> String {
    let Some((effect, location)) = score.named.first() else {
        return if score.error.is_some() { "failed".into() } else { NOTHING.into() };
    };
    let elsewhere =
        score.hidden.first().is_some_and(|hidden| hidden.effect == *effect && hidden.place != *location);
    if elsewhere { format!("{effect} elsewhere") } else { effect.clone() }
}
