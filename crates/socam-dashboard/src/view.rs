//! The views: what each of them is, and the list of all.

use egui::Ui;
use serde::{Deserialize, Serialize};

use crate::check::Checks;
use crate::diagnosis::DiagnosisView;
#[cfg(not(target_arch = "wasm32"))]
use crate::fleet::FleetView;
use crate::identify::Identify;
use crate::live::Live;
use crate::review::Review;
use crate::spectra::Spectra;
#[cfg(not(target_arch = "wasm32"))]
use crate::watch::WatchView;
use crate::workspace::Workspace;

/// Names of controls, separated by `; ` and with `...` for variable parts, and their explanation.
pub type Help = &'static [(&'static str, &'static str)];

/// A view. To add one, write a type with these functions, and one line in `views!` below.
pub trait ViewPanel {
    /// Draws what stays in its place below the tabs, whatever messages appear below it.
    fn bar(&mut self, _ui: &mut Ui) {}

    /// Draws it.
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace);

    /// Takes the results of work on other threads. Called in every pass, whether the view is shown or not.
    fn poll(&mut self, _ctx: &egui::Context, _workspace: &mut Workspace) {}

    /// Whether something is being computed.
    fn is_busy(&self) -> bool {
        false
    }

    /// Whether it shows or uses open recordings. Opening one in another view leads to the view over time.
    fn uses_recordings(&self) -> bool {
        true
    }

    /// Whether it has a history of what it shows, which undo and redo then use.
    fn has_history(&self) -> bool {
        false
    }

    /// Undoes a change of what it shows.
    fn undo(&mut self, _workspace: &mut Workspace) {}

    /// Does again what was undone.
    fn redo(&mut self, _workspace: &mut Workspace) {}

    /// Explains its controls.
    fn help() -> Help
    where
        Self: Sized;
}

/// Declares [`View`], the names of all views in the order of their tabs, and [`Views`], their states.
macro_rules! views {
    ($($(#[cfg($where:meta)])? $(#[serde($alias:meta)])? $name:ident: $field:ident = $state:ty, $what:literal;)+) => {
        /// The name of a view.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
        pub enum View {
            $($(#[cfg($where)])? $(#[serde($alias)])? #[doc = $what] $name,)+
        }

        impl View {
            /// All of them, in the order of their tabs.
            pub const ALL: &[Self] = &[$($(#[cfg($where)])? Self::$name),+];

            /// Its name.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $($(#[cfg($where)])? Self::$name => stringify!($name),)+
                }
            }

            /// Explains its controls.
            #[must_use]
            pub fn help(self) -> Help {
                match self {
                    $($(#[cfg($where)])? Self::$name => <$state>::help(),)+
                }
            }
        }

        /// The states of all views.
        #[derive(Debug, Default)]
        pub struct Views {
            $($(#[cfg($where)])? #[doc = $what] pub $field: $state,)+
        }

        impl Views {
            pub(crate) fn peek(&self, view: View) -> &dyn ViewPanel {
                match view {
                    $($(#[cfg($where)])? View::$name => &self.$field,)+
                }
            }

            pub(crate) fn get(&mut self, view: View) -> &mut dyn ViewPanel {
                match view {
                    $($(#[cfg($where)])? View::$name => &mut self.$field,)+
                }
            }

            pub(crate) fn is_busy(&self) -> bool {
                let mut is_busy = false;
                $($(#[cfg($where)])? { is_busy |= self.$field.is_busy(); })+
                is_busy
            }
        }
    };
}

views! {
    Live: live = Live, "The running bench.";
    Time: time = Review, "Recordings over time.";
    Frequency: frequency = Spectra, "Spectra, responses, poles and zeros.";
    Check: check = Checks, "Whether recordings can carry a fit.";
    // Layouts of earlier versions call it by its result.
    #[serde(alias = "Parameters")]
    Identify: identify = Identify, "Parameters of the model, from recordings.";
    Diagnosis: diagnosis = DiagnosisView, "What physics the model lacks.";
    #[cfg(not(target_arch = "wasm32"))]
    Watch: watch = WatchView, "A bench or recording with the model running beside it.";
    #[cfg(not(target_arch = "wasm32"))]
    Fleet: fleet = FleetView, "What the recordings of many machines say together.";
}

impl View {
    /// Views that have a tab on this platform.
    pub(crate) fn reachable() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|view| crate::live::REACHABLE || *view != Self::Live)
    }
}
