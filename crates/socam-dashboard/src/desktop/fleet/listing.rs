//! Machines and parameters that are listed at a false discovery rate, and the order in which machines are shown.

use std::collections::BTreeSet;
use std::sync::Arc;

use socam_findings::words;
use socam_fleet::{Group, Machine, Summary, Survey};

use socam_chart::table::{Key, Sorting, sorted};

/// Results at a false discovery rate.
#[derive(Debug)]
pub(super) struct Listing {
    pub(super) summary: Summary,
    /// Lines, one for each machine of the survey.
    pub(super) lines: Vec<Line>,
    /// Number of machines that stand out.
    pub(super) notable: usize,
    /// The last wish and its answer.
    kept: Option<(Wish, Arc<[usize]>)>,
}

/// Results for one machine.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Line {
    /// Whether it lacks physics.
    pub(super) lacks: bool,
    /// Number of its parameters that change.
    pub(super) changes: u32,
    /// Number of its parameters that differ from its sisters'.
    pub(super) differs: u32,
}

impl Line {
    pub(super) fn is_notable(self) -> bool {
        self.lacks || self.changes + self.differs > 0
    }
}

/// Filter and order of the machines that are shown.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Wish {
    /// Text that the names must contain.
    pub(super) search: String,
    /// Only those that stand out.
    pub(super) only_notable: bool,
    /// Only those with this effect at this place.
    pub(super) group: Option<(String, String)>,
    pub(super) sorting: Option<Sorting>,
}

impl Listing {
    pub(super) fn of(survey: &Survey, fdr: f64) -> Self {
        let summary = survey.at(fdr);
        let mut lines = vec![Line::default(); survey.machines.len()];
        let mut mark = |name: &str, mark: &dyn Fn(&mut Line)| {
            if let Some(line) = place(survey, name).and_then(|place| lines.get_mut(place)) {
                mark(line);
            }
        };
        summary.faulty.iter().for_each(|one| mark(&one.machine, &|line| line.lacks = true));
        summary.trends.iter().for_each(|one| mark(&one.machine, &|line| line.changes += 1));
        summary.differences.iter().for_each(|one| mark(&one.machine, &|line| line.differs += 1));
        let notable = lines.iter().filter(|line| line.is_notable()).count();
        Self { summary, lines, notable, kept: None }
    }

    /// Places of the machines that are wished for, in the order that is. It is kept until another one is wished for.
    pub(super) fn order(&mut self, survey: &Survey, wish: &Wish) -> Arc<[usize]> {
        if let Some((kept, order)) = &self.kept
            && kept == wish
        {
            return Arc::clone(order);
        }
        let order: Arc<[usize]> = self.ordered(survey, wish).into();
        self.kept = Some((wish.clone(), Arc::clone(&order)));
        order
    }

    fn ordered(&self, survey: &Survey, wish: &Wish) -> Vec<usize> {
        let search = wish.search.to_lowercase();
        let of_group = wish.group.as_ref().map(|key| self.members(survey, key));
        let is_wanted = |place: &usize| {
            (search.is_empty() || survey.machines[*place].name.to_lowercase().contains(&search))
                && (!wish.only_notable || self.lines[*place].is_notable())
                && of_group.as_ref().is_none_or(|group| group.contains(place))
        };
        let places: Vec<usize> = (0..survey.machines.len()).filter(is_wanted).collect();
        let key = |place: &usize| match wish.sorting {
            Some(by) => self.key(&survey.machines[*place], *place, by.column),
            // Without a choice of the user, machines that stand out come first, in the order of their p-values.
            None => {
                let behind = if self.lines[*place].is_notable() { 0.0 } else { 2.0 };
                Key::Number(behind + survey.machines[*place].p_and_q.map_or(1.0, |(p, _)| p))
            }
        };
        let keys: Vec<Key> = places.iter().map(key).collect();
        let is_descending = wish.sorting.is_some_and(|by| by.is_descending);
        sorted(&keys, is_descending).into_iter().map(|index| places[index]).collect()
    }

    fn members(&self, survey: &Survey, key: &(String, String)) -> BTreeSet<usize> {
        let group = self.summary.groups.iter().find(|group| is(group, key));
        let members = group.into_iter().flat_map(|group| &group.members);
        members.filter_map(|member| place(survey, &member.machine)).collect()
    }

    fn key(&self, machine: &Machine, place: usize, column: usize) -> Key {
        let line = self.lines[place];
        match column {
            0 => machine.name.as_str().into(),
            1 => self.missing(machine, place).as_str().into(),
            2 => machine.p_and_q.map(|(p, _)| p).into(),
            3 => Key::Number(f64::from(line.changes)),
            4 => Key::Number(f64::from(line.differs)),
            5 => share(machine).into(),
            _ => Key::Number(machine.counts.recordings as f64),
        }
    }

    /// Missing effects of a listed machine, as text. Empty for other machines, on which chance makes some findings.
    pub(super) fn missing(&self, machine: &Machine, place: usize) -> String {
        if !self.lines[place].lacks {
            return String::new();
        }
        if machine.findings.is_empty() {
            return socam_fleet::words::UNNAMED.into();
        }
        let names = machine.findings.iter().map(|key| match key.split_once('@') {
            Some((effect, place)) => at(effect, place),
            None => key.clone(),
        });
        names.collect::<Vec<_>>().join(", ")
    }
}

/// Share of a machine's verdicts that are adequate.
pub(super) fn share(machine: &Machine) -> Option<f64> {
    let counts = &machine.counts;
    let judged = counts.recordings - counts.without();
    (judged > 0).then(|| counts.adequate as f64 / judged as f64)
}

/// Place of a machine in the survey.
pub(super) fn place(survey: &Survey, name: &str) -> Option<usize> {
    survey.machines.binary_search_by(|machine| machine.name.as_str().cmp(name)).ok()
}

pub(super) fn is(group: &Group, (effect, place): &(String, String)) -> bool {
    group.effect == *effect && group.place == *place
}

/// `Coulomb friction at load`
pub(super) fn at(effect: &str, place: &str) -> String {
    format!("{} at {place}", words::effect(effect))
}
