//! Undo and redo of changes of the model's parameters.

use socam_model::Model;

/// Most steps that are kept.
const MOST: usize = 100;

/// The models before and after the present one.
#[derive(Debug, Clone, Default)]
pub struct ModelHistory {
    before: Vec<Model>,
    after: Vec<Model>,
    /// Number of the model that the history belongs to; see [`crate::Workspace::revision`].
    revision: u64,
}

impl ModelHistory {
    /// Forgets everything when the model of the window is another one than the history's.
    pub fn belong_to(&mut self, revision: u64) {
        if self.revision != revision {
            *self = Self { revision, ..Self::default() };
        }
    }

    /// Keeps the model before a change; `revision` is the number of the model after it.
    pub fn changed(&mut self, before: Model, revision: u64) {
        self.after.clear();
        self.before.push(before);
        if self.before.len() > MOST {
            self.before.remove(0);
        }
        self.revision = revision;
    }

    /// Whether there is something to undo, and to redo.
    #[must_use]
    pub fn can(&self) -> [bool; 2] {
        [!self.before.is_empty(), !self.after.is_empty()]
    }

    /// The model before the last change; `present` can be done again. `revision` is the number that the returned model gets.
    pub fn undo(&mut self, present: Model, revision: u64) -> Option<Model> {
        let model = self.before.pop()?;
        self.after.push(present);
        self.revision = revision;
        Some(model)
    }

    /// The model after the change that was undone last.
    pub fn redo(&mut self, present: Model, revision: u64) -> Option<Model> {
        let model = self.after.pop()?;
        self.before.push(present);
        self.revision = revision;
        Some(model)
    }
}
