//! Undo of changes of what is shown.

/// Changes within this time count as one: a turn of the wheel or a drag is many small ones.
const TOGETHER_S: f64 = 0.6;
/// Number of views that are kept.
const KEPT: usize = 100;

/// Earlier and later views, such as the ranges of axes.
#[derive(Debug, Clone)]
pub struct ViewHistory<T> {
    views: Vec<T>,
    /// Index of the view that is shown.
    now: usize,
    changed_s: f64,
}

impl<T: Clone + PartialEq> ViewHistory<T> {
    /// A history that begins with a view.
    #[must_use]
    pub fn new(first: T) -> Self {
        Self { views: vec![first], now: 0, changed_s: f64::NEG_INFINITY }
    }

    /// Records the view that is shown at `time_s`, such as in every frame. A change discards the views that were undone.
    pub fn note(&mut self, view: &T, time_s: f64) {
        if self.views[self.now] == *view {
            return;
        }
        self.views.truncate(self.now + 1);
        if self.now > 0 && time_s - self.changed_s < TOGETHER_S {
            self.views[self.now] = view.clone();
        } else {
            self.views.push(view.clone());
            if self.views.len() > KEPT {
                self.views.remove(0);
            }
            self.now = self.views.len() - 1;
        }
        self.changed_s = time_s;
    }

    /// Replaces what is shown: a change that is not the user's, and is not undone.
    pub fn amend(&mut self, view: T) {
        self.views[self.now] = view;
    }

    /// The view before the one that is shown, which is then shown.
    pub fn undo(&mut self) -> Option<T> {
        self.now = self.now.checked_sub(1)?;
        self.changed_s = f64::NEG_INFINITY;
        Some(self.views[self.now].clone())
    }

    /// The view that was undone last.
    pub fn redo(&mut self) -> Option<T> {
        let view = self.views.get(self.now + 1)?.clone();
        self.now += 1;
        self.changed_s = f64::NEG_INFINITY;
        Some(view)
    }

    /// Whether there is something to undo, and something to redo.
    #[must_use]
    pub fn can(&self) -> [bool; 2] {
        [self.now > 0, self.now + 1 < self.views.len()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_undone_and_done_again() {
        let mut history = ViewHistory::new([0.0, 10.0]);
        assert_eq!((history.undo(), history.redo()), (None, None));
        // A turn of the wheel, then, later, a drag.
        for (time_s, view) in [(1.0, [1.0, 9.0]), (1.1, [2.0, 8.0]), (1.2, [3.0, 7.0]), (5.0, [4.0, 8.0])] {
            history.note(&view, time_s);
        }
        history.note(&[4.0, 8.0], 5.1);
        assert_eq!(history.undo(), Some([3.0, 7.0]));
        // The view that undo gave is noted in the next frame and changes nothing.
        history.note(&[3.0, 7.0], 6.0);
        assert_eq!(history.undo(), Some([0.0, 10.0]));
        assert_eq!(history.can(), [false, true]);
        assert_eq!(history.redo(), Some([3.0, 7.0]));
        history.note(&[3.5, 6.5], 6.1);
        assert_eq!(history.redo(), None);
        assert_eq!(history.undo(), Some([3.0, 7.0]));
    }

    #[test]
    fn it_forgets_the_oldest() {
        let mut history = ViewHistory::new(0);
        (1..1000).for_each(|view| history.note(&view, f64::from(view)));
        assert_eq!(history.views.len(), KEPT);
        let mut oldest = None;
        while let Some(view) = history.undo() {
            oldest = Some(view);
        }
        assert_eq!(oldest, Some(900));
    }
}
