//! Rules on the rows of a recording.

use serde::Serialize;
use socam_model::formula::{Formula, FormulaProblem, Tape};
use socam_recording::{Block, Channel, Dataset};
use socam_units::Scale;

use crate::{
    error::RulesError,
    file::{Rule, Rules},
};

/// Most episodes of one rule that are listed.
const MOST_EPISODES: usize = 100;

/// Whether a rule was kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Keeping {
    /// At every row that has a value.
    Kept,
    /// For longer than it allows.
    Broken,
    /// No row has a value of it.
    NotJudged,
}

/// What a recording says of a rule.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Name of the rule.
    pub rule: String,
    /// Whether it was kept.
    pub keeping: Keeping,
    /// Unit of the values.
    pub unit: String,
    /// Number of episodes in which it was broken.
    pub times: usize,
    /// The first of them.
    pub episodes: Vec<Episode>,
    /// Rows at which a channel of the formula, or the formula itself, has no value.
    pub rows_not_judged: u64,
}

/// Rows after each other at which a rule was broken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Episode {
    /// Time of the first row, s.
    pub from_s: f64,
    /// Time of the last row, s.
    pub to_s: f64,
    /// The value that is farthest beyond the limit, in the rule's unit.
    pub worst: f64,
    /// Time of that row, s.
    pub worst_s: f64,
}

/// Rules bound to the channels of recordings.
#[derive(Debug)]
pub struct Judge<'r> {
    bound: Vec<Bound<'r>>,
}

#[derive(Debug)]
struct Bound<'r> {
    rule: &'r Rule,
    formula: Tape,
    channels: Vec<usize>,
    scale: Scale,
}

impl<'r> Judge<'r> {
    /// Binds rules to the channels of a recording.
    ///
    /// # Errors
    /// [`RulesError::Unfit`] where a formula names what is no channel, or is in another unit than its limits.
    pub fn new(rules: &'r Rules, data: &Dataset) -> Result<Self, RulesError> {
        let bound = rules.all.iter().map(|rule| Bound::new(rule, data));
        Ok(Self { bound: bound.collect::<Result<_, _>>()? })
    }

    /// What a recording says of each rule, in one pass; it must have the channels of the one to which the rules were bound.
    ///
    /// # Errors
    /// [`RulesError::Recording`] where it cannot be read.
    pub fn verdicts(&self, data: &Dataset) -> Result<Vec<Verdict>, RulesError> {
        let mut channels: Vec<usize> =
            self.bound.iter().flat_map(|bound| bound.channels.iter().copied()).collect();
        channels.sort_unstable();
        channels.dedup();
        let mut hearings: Vec<Hearing<'_>> =
            self.bound.iter().map(|bound| Hearing::new(bound, &channels)).collect();
        let mut segment = None;
        for block in data.blocks_in(0..data.rows(), &channels)? {
            let block = block?;
            let is_behind_gap = segment.replace(block.segment) != Some(block.segment);
            hearings.iter_mut().for_each(|hearing| hearing.take(&block, is_behind_gap));
        }
        Ok(hearings.into_iter().map(Hearing::verdict).collect())
    }
}

impl<'r> Bound<'r> {
    fn new(rule: &'r Rule, data: &Dataset) -> Result<Self, RulesError> {
        let fail = |problem: String| RulesError::Unfit { line: rule.line, rule: rule.name.clone(), problem };
        let in_formula = |problem: FormulaProblem| fail(format!("formula, {problem}"));
        let names = Formula::parse(&rule.formula).map_err(in_formula)?.all_names();
        let (mut channels, mut inputs) = (Vec::new(), Vec::new());
        for name in names.into_iter().filter(|name| name != "pi") {
            let index = named(data, &name).map_err(fail)?;
            channels.push(index);
            inputs.push((name, data.channels()[index].unit.symbol()));
        }
        let formula = Tape::over(&rule.formula, &inputs, &rule.unit).map_err(in_formula)?;
        let scale = socam_units::parse(&rule.unit)
            .ok_or_else(|| fail(format!("unit is \"{}\", which is unknown", rule.unit)))?;
        Ok(Self { rule, formula, channels, scale })
    }

    /// How far a value is beyond a limit; `None` where it keeps to both, or there is none.
    fn beyond(&self, value: f64) -> Option<f64> {
        let below = self.rule.below.map(|most| value - most);
        let above = self.rule.above.map(|least| least - value);
        [below, above].into_iter().flatten().filter(|beyond| *beyond >= 0.0).reduce(f64::max)
    }
}

/// A rule while rows are read.
struct Hearing<'b> {
    bound: &'b Bound<'b>,
    /// Places of its channels among those that are read.
    columns: Vec<usize>,
    inputs: Vec<f64>,
    episodes: Episodes,
    judged: u64,
    missing: u64,
}

impl<'b> Hearing<'b> {
    fn new(bound: &'b Bound<'b>, read: &[usize]) -> Self {
        let columns: Vec<usize> =
            bound.channels.iter().filter_map(|own| read.iter().position(|channel| channel == own)).collect();
        let inputs = vec![0.0; columns.len()];
        Self { bound, columns, inputs, episodes: Episodes::default(), judged: 0, missing: 0 }
    }

    fn take(&mut self, block: &Block, is_behind_gap: bool) {
        let Bound { rule, formula, scale, .. } = self.bound;
        if is_behind_gap {
            self.episodes.end(rule.for_s);
        }
        for (row, time_s) in block.time_s.iter().enumerate() {
            for (input, column) in self.inputs.iter_mut().zip(&self.columns) {
                *input = block.columns[*column].values()[row];
            }
            let value = (formula.value(&self.inputs) - scale.offset) / scale.factor;
            if value.is_finite() {
                self.judged += 1;
            } else {
                self.missing += 1;
            }
            match self.bound.beyond(value) {
                Some(beyond) => self.episodes.go_on(*time_s, value, beyond),
                None => self.episodes.end(rule.for_s),
            }
        }
    }

    fn verdict(mut self) -> Verdict {
        let rule = self.bound.rule;
        self.episodes.end(rule.for_s);
        let keeping = match (self.judged, self.episodes.times) {
            (0, _) => Keeping::NotJudged,
            (_, 0) => Keeping::Kept,
            _ => Keeping::Broken,
        };
        Verdict {
            rule: rule.name.clone(),
            keeping,
            unit: rule.unit.clone(),
            times: self.episodes.times,
            episodes: self.episodes.first,
            rows_not_judged: self.missing,
        }
    }
}

/// The channel that a formula names; the error continues a sentence that begins with the name of a rule.
fn named(data: &Dataset, name: &str) -> Result<usize, String> {
    let spelled: Vec<String> = data.channels().iter().map(spelled).collect();
    let mut found = (0..spelled.len()).filter(|index| spelled[*index] == name);
    match (found.next(), found.next()) {
        (Some(index), None) => Ok(index),
        (Some(_), Some(_)) => Err(format!(
            "formula names {name}, and two channels of {} are spelled so; rename one",
            data.name()
        )),
        _ => Err(format!(
            "formula names {name}, and {} has no such channel; its channels are {}",
            data.name(),
            spelled.join(", ")
        )),
    }
}

/// The name of a channel in formulas.
fn spelled(channel: &Channel) -> String {
    channel.name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect()
}

/// The episodes of one rule while rows are read.
#[derive(Default)]
struct Episodes {
    open: Option<(Episode, f64)>,
    times: usize,
    first: Vec<Episode>,
}

impl Episodes {
    fn go_on(&mut self, time_s: f64, worst: f64, beyond: f64) {
        let begun = Episode { from_s: time_s, to_s: time_s, worst, worst_s: time_s };
        let (episode, most) = self.open.get_or_insert((begun, beyond));
        episode.to_s = time_s;
        if beyond > *most {
            (episode.worst, episode.worst_s, *most) = (worst, time_s, beyond);
        }
    }

    /// Ends an episode, which counts if it took longer than a rule allows, or as long as a rule allows that is none.
    fn end(&mut self, for_s: f64) {
        let Some((episode, _)) = self.open.take() else { return };
        if for_s == 0.0 || episode.to_s - episode.from_s > for_s {
            self.times += 1;
            if self.first.len() < MOST_EPISODES {
                self.first.push(episode);
            }
        }
    }
}

impl Verdict {
    /// The verdict in words, after the rule's name.
    #[must_use]
    pub fn sentence(&self) -> String {
        let rows = match self.rows_not_judged {
            0 => String::new(),
            rows => format!("; {rows} rows have no value of it"),
        };
        let broken = |episode: &Episode| {
            let more = match self.times {
                1 => String::new(),
                times => format!(", and {} more times", times - 1),
            };
            format!(
                "broken from {} s to {} s, worst {} {} at {} s{more}",
                Short(episode.from_s),
                Short(episode.to_s),
                Short(episode.worst),
                self.unit,
                Short(episode.worst_s)
            )
        };
        let own = match (self.keeping, self.episodes.first()) {
            (Keeping::Broken, Some(episode)) => broken(episode),
            (Keeping::NotJudged, _) => return "not judged: no row has a value of its formula".to_owned(),
            _ => "kept".to_owned(),
        };
        format!("{own}{rows}")
    }
}

/// A number without the zeros at its end.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digits = (5 - self.0.abs().max(1e-3).log10().floor() as i32).clamp(0, 8);
        let text = format!("{:.*}", digits as usize, self.0);
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        f.write_str(text)
    }
}

#[cfg(test)]
mod tests {
    use socam_recording::Unit;

    use super::*;

    /// A torque that is above 2 N m from 0.3 s to 0.5 s and at 0.8 s.
    fn data() -> Dataset {
        let torque = [0.0, 1.0, 1.5, 2.5, -3.5, 2.1, 1.0, 0.0, 2.2, f64::NAN, 0.0];
        let time_s = (0..torque.len()).map(|k| 0.1 * k as f64).collect();
        let channels = vec![Channel::new("motor torque", Unit::Nm), Channel::new("speed", Unit::RadPerS)];
        Dataset::from_columns("run", channels, time_s, vec![torque.to_vec(), vec![10.0; torque.len()]])
            .unwrap()
    }

    fn rules(more: &str) -> Rules {
        Rules::parse(&format!("[rules.load]\n{more}")).unwrap()
    }

    fn verdict(more: &str) -> Verdict {
        let (rules, data) = (rules(more), data());
        Judge::new(&rules, &data).unwrap().verdicts(&data).unwrap().remove(0)
    }

    #[test]
    fn a_rule_is_broken_where_its_formula_is_beyond_for_long_enough() {
        let found = verdict("formula = \"abs(motor_torque)\"\nunit = \"mN m\"\nbelow = 2000");
        assert_eq!((found.keeping, found.times, found.rows_not_judged), (Keeping::Broken, 2, 1));
        let episode = found.episodes[0];
        assert!((episode.from_s - 0.3).abs() < 1e-12 && (episode.to_s - 0.5).abs() < 1e-12, "{episode:?}");
        assert!(
            (episode.worst - 3500.0).abs() < 1e-9 && (episode.worst_s - 0.4).abs() < 1e-12,
            "{episode:?}"
        );
        assert_eq!(
            found.sentence(),
            "broken from 0.3 s to 0.5 s, worst 3500 mN m at 0.4 s, and 1 more times; 1 rows have no value of it"
        );
        let longer = "formula = \"abs(motor_torque)\"\nunit = \"N m\"\nbelow = 2\nfor_s =";
        assert_eq!(verdict(&format!("{longer} 0.1")).times, 1);
        assert_eq!(verdict(&format!("{longer} 0.3")).keeping, Keeping::Kept);
        assert_eq!(verdict("formula = \"motor_torque*speed\"\nunit = \"N m rad/s\"\nabove = -30").times, 1);
    }

    #[test]
    fn what_no_row_has_a_value_of_is_not_judged() {
        let found = verdict("formula = \"log(0*motor_torque) + speed/speed\"\nunit = \"1\"\nbelow = 2");
        assert_eq!((found.keeping, found.rows_not_judged), (Keeping::NotJudged, 11));
    }

    #[test]
    fn a_rule_that_does_not_go_with_the_channels_says_why() {
        let data = data();
        for (more, words) in [
            (
                "formula = \"abs(torque)\"\nunit = \"N m\"\nbelow = 2",
                "line 2: rules.load.formula names torque, and run has no such channel; its channels are motor_torque, speed",
            ),
            ("formula = \"speed\"\nunit = \"N m\"\nbelow = 2", "is in \"rad/s\""),
            ("formula = \"speed + motor_torque\"\nunit = \"N m\"\nbelow = 2", "+ joins"),
        ] {
            let rules = rules(more);
            let problem = Judge::new(&rules, &data).unwrap_err().to_string();
            assert!(problem.contains(words), "{problem}");
        }
        for (more, words) in [
            ("formula = \"speed\"\nunit = \"rpm\"", "has no limit"),
            ("formula = \"speed\"\nunit = \"furlong\"\nbelow = 1", "the unit of load is \"furlong\""),
            ("formula = \"speed\"\nunit = \"rpm\"\nbelow = 1\nabove = 1", "cannot be kept"),
            ("formula = \"speed\"\nunit = \"rpm\"\nbelow = 1\nfor = 1", "`for` is not a key here"),
            ("unit = \"rpm\"\nbelow = 1", "`formula` is missing"),
        ] {
            let problem = Rules::parse(&format!("[rules.load]\n{more}")).unwrap_err().to_string();
            assert!(problem.contains(words), "{problem}");
        }
        assert!(Rules::parse("").unwrap_err().to_string().contains("there is no rule"));
    }
}
