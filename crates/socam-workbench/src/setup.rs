//! The set-up of the next identification or diagnosis.

use std::collections::BTreeMap;

use socam_model::{BUILTIN, Model};

use crate::about::short;
use crate::entry::Entry;
use crate::recording::Recording;

/// Role of a recording in an identification or diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Role {
    /// The recording is fitted.
    #[default]
    Fit,
    /// The recording is not fitted but predicted, for validation.
    HoldOut,
    /// The recording is left out.
    Unused,
}

/// Roles by the name of the recording. A recording that is hidden is not used unless somebody chose its role.
#[derive(Debug, Clone, Default)]
pub struct Roles(BTreeMap<String, Role>);

impl Roles {
    /// Role of a recording.
    #[must_use]
    pub fn of(&self, entry: &Entry) -> Role {
        let usual = if entry.shown { Role::Fit } else { Role::Unused };
        self.0.get(&entry.recording.about.name).copied().unwrap_or(usual)
    }

    /// Sets what a recording is used for.
    pub fn set(&mut self, name: &str, role: Role) {
        self.0.insert(name.to_owned(), role);
    }
}

/// Changes of a model's parameters, by name, and the model that they belong to.
#[derive(Debug, Clone, Default)]
pub struct Changes {
    of: u64,
    by_name: BTreeMap<String, (f64, bool)>,
}

impl Changes {
    /// Changes of the model of this revision; those of another one are dropped.
    pub fn belong_to(&mut self, revision: u64) {
        if self.of != revision {
            *self = Self { of: revision, ..Self::default() };
        }
    }

    /// Sets a parameter's start value, SI, and whether it is fixed there.
    pub fn set(&mut self, name: &str, value: f64, is_fixed: bool) {
        self.by_name.insert(name.to_owned(), (value, is_fixed));
    }

    /// The model with the changes.
    #[must_use]
    pub fn applied(&self, model: &Model) -> Model {
        let mut changed = model.clone();
        for parameter in &mut changed.parameters {
            if let Some((value, is_fixed)) = self.by_name.get(&parameter.name) {
                (parameter.value, parameter.fixed) = (*value, *is_fixed);
            }
        }
        changed
    }

    /// `Start values: 3 of 12 parameters are fixed`
    #[must_use]
    pub fn summary(&self, model: &Model) -> String {
        let fixed = self.applied(model).parameters.iter().filter(|parameter| parameter.fixed).count();
        format!("Start values: {fixed} of {} parameters are fixed", model.parameters.len())
    }

    /// Forgets all changes.
    pub fn clear(&mut self) {
        self.by_name.clear();
    }

    /// Whether nothing is changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.by_name.is_empty()
    }
}

/// Roles of the recordings (fitted or held out), and fixed parameters. Both views show the same set-up.
#[derive(Debug, Clone, Default)]
pub struct Setup {
    /// Role of each recording.
    pub roles: Roles,
    /// Start values and fixed parameters.
    pub changes: Changes,
    /// The range that is read of each recording, s, in the time of the view over time; all of it without one.
    pub range_s: Option<[f64; 2]>,
}

/// Recordings and model of the next fit.
#[derive(Debug, Clone)]
pub struct Chosen {
    /// The model with start values and fixed parameters.
    pub model: Model,
    /// Recordings that are fitted.
    pub training: Vec<Recording>,
    /// Recordings that are only predicted.
    pub held_out: Vec<Recording>,
}

impl Setup {
    /// Sets what a recording is used for.
    pub fn use_as(&mut self, name: &str, role: Role) {
        self.roles.set(name, role);
    }

    /// Sets a parameter's start value, SI, and whether it is fixed there.
    pub fn set_parameter(&mut self, name: &str, value: f64, is_fixed: bool) {
        self.changes.set(name, value, is_fixed);
    }

    /// Recordings and model of the next fit.
    ///
    /// # Errors
    /// Why nothing can be started; one sentence.
    pub fn chosen(&self, entries: &[Entry], model: &Model) -> Result<Chosen, String> {
        let of = |role: Role| -> Result<Vec<Recording>, String> {
            let own = entries.iter().filter(|entry| self.roles.of(entry) == role);
            own.map(|entry| self.read_of(entry)).collect()
        };
        let chosen = Chosen {
            model: self.changes.applied(model),
            training: of(Role::Fit)?,
            held_out: of(Role::HoldOut)?,
        };
        match chosen.problem(entries.is_empty()) {
            Some(problem) => Err(problem),
            None => Ok(chosen),
        }
    }
}

impl Setup {
    /// The part of a recording that is read.
    fn read_of(&self, entry: &Entry) -> Result<Recording, String> {
        match self.range_s {
            Some(range_s) => entry.recording.part(range_s.map(|time| time - entry.shift_s)),
            None => Ok(entry.recording.clone()),
        }
    }
}

impl Chosen {
    fn problem(&self, is_empty: bool) -> Option<String> {
        if is_empty {
            return Some("No recording is open: press Ctrl+O.".into());
        }
        if self.training.is_empty() {
            return Some("No recording is fitted: choose `fit` for at least one.".into());
        }
        let used: Vec<&Recording> = self.training.iter().chain(&self.held_out).collect();
        for (index, recording) in used.iter().enumerate() {
            let name = &recording.about.name;
            if used[..index].iter().any(|other| other.about.name == *name) {
                return Some(format!(
                    "{} is open twice; its samples would count double: close one.",
                    short(name)
                ));
            }
            if let Some(problem) = self.lacking(recording) {
                return Some(problem);
            }
        }
        self.parameters()
    }

    /// Says which channel of the model a recording lacks.
    fn lacking(&self, recording: &Recording) -> Option<String> {
        let has = |column: &str| {
            let mut channels = recording.about.channels.iter();
            channels.any(|own| own.name == column || own.column_name() == column)
        };
        let channels = self.model.inputs().chain(self.model.outputs());
        let read = channels.filter(|channel| !channel.quantity.is_clock());
        let missing: Vec<&str> =
            read.map(|channel| channel.column.as_str()).filter(|column| !has(column)).collect();
        (!missing.is_empty()).then(|| {
            format!(
                "{} lacks {}, which the model {} reads: choose another model or another recording.",
                short(&recording.about.name),
                missing.join(", "),
                self.model.name
            )
        })
    }

    fn parameters(&self) -> Option<String> {
        let parameters = &self.model.parameters;
        let outside = |p: &&socam_model::Parameter| !p.fixed && !(p.bounds.0..=p.bounds.1).contains(&p.value);
        if let Some(parameter) = parameters.iter().find(outside) {
            return Some(format!("{} starts outside its bounds: change its start value.", parameter.name));
        }
        self.model.equations(&self.model.values()).err().map(|error| format!("{error}."))
    }
}

/// Whether a model is one that is built in.
#[must_use]
pub fn is_built_in(model: &Model) -> bool {
    BUILTIN.iter().any(|(_, text)| model.text == *text)
}
