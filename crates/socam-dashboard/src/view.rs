//! The views: what each of them is, and the list of all.

use egui::Ui;
use serde::{Deserialize, Serialize};

use crate::check::Checks;
use crate::diagnosis::DiagnosisView;
use crate::live::Live;
use crate::parameters::Parameters;
use crate::review::Review;
use crate::spectra::Spectra;
use crate::workspace::Workspace;

/// Names of controls, separated by `; ` and with `...` for variable parts, and their explanation.
pub type Help = &'static [(&'static str, &'static str)];

/// A view. To add one, write a type with these functions, and one line in [`views`].
pub trait ViewPanel {
    /// Draws it.
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace);

    /// Takes the results of work on other threads. Called in every pass, whether the view is shown or not.
    fn poll(&mut self, _ctx: &egui::Context, _workspace: &mut Workspace) {}

    /// Whether something is being computed.
    fn is_busy(&self) -> bool {
        false
    }

    /// Undoes a change of what it shows; `false` if it has no such history.
    fn undo(&mut self, _workspace: &mut Workspace) -> bool {
        false
    }

    /// Does again what was undone; `false` if it has no such history.
    fn redo(&mut self, _workspace: &mut Workspace) -> bool {
        false
    }

    /// Explains its controls.
    fn help() -> Help
    where
        Self: Sized;
}

/// Declares [`View`], the names of all views in the order of their tabs, and [`Views`], their states.
macro_rules! views {
    ($($name:ident: $field:ident = $state:ty, $what:literal;)+) => {
        /// The name of a view.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
        pub enum View {
            $(#[doc = $what] $name,)+
        }

        impl View {
            /// All of them, in the order of their tabs.
            pub const ALL: &[Self] = &[$(Self::$name),+];

            /// Its name.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$name => stringify!($name),)+
                }
            }

            /// Explains its controls.
            #[must_use]
            pub fn help(self) -> Help {
                match self {
                    $(Self::$name => <$state>::help(),)+
                }
            }
        }

        /// The states of all views.
        #[derive(Debug, Default)]
        pub struct Views {
            $(#[doc = $what] pub $field: $state,)+
        }

        impl Views {
            pub(crate) fn get(&mut self, view: View) -> &mut dyn ViewPanel {
                match view {
                    $(View::$name => &mut self.$field,)+
                }
            }

            pub(crate) fn is_busy(&self) -> bool {
                $(self.$field.is_busy() ||)+ false
            }
        }
    };
}

views! {
    Live: live = Live, "The running bench.";
    Time: time = Review, "Recordings over time.";
    Frequency: frequency = Spectra, "Spectra, responses, poles and zeros.";
    Check: check = Checks, "Whether recordings can carry a fit.";
    Parameters: parameters = Parameters, "An identification.";
    Diagnosis: diagnosis = DiagnosisView, "What physics the model lacks.";
}

impl View {
    /// Views that have a tab on this platform.
    pub(crate) fn reachable() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|view| crate::live::REACHABLE || *view != Self::Live)
    }
}
