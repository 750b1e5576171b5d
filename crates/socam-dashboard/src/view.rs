//! Definition of a view. To add one, write a type with the functions of [`ViewPanel`], its name in [`socam_workbench::View`], and
//! one line in `views!` of each platform that has it.

use egui::Ui;
use socam_chart::chart::Seen;
use socam_workbench::Workspace;

/// Names of controls, separated by `; ` and with `...` for variable parts, and their explanation.
pub type Help = &'static [(&'static str, &'static str)];

/// A view.
pub trait ViewPanel {
    /// Draws the part that stays in its place below the tabs, whatever messages appear below it.
    fn bar(&mut self, _ui: &mut Ui, _workspace: &mut Workspace) {}

    /// Draws it, and adds its charts to those that are seen.
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, seen: &mut Vec<Seen>);

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

    /// The command that does the same as the view with its present set-up; `None` where there is none.
    fn command(&self, _workspace: &Workspace) -> Option<String> {
        None
    }

    /// Whether it identifies or diagnoses, and is not busy with it.
    fn can_start(&self) -> bool {
        false
    }

    /// Begins to identify or to diagnose with its present set-up, or says why it cannot.
    fn start(&mut self, _ctx: &egui::Context, _workspace: &mut Workspace) {}

    /// Whether it shows what a report can be written of.
    fn has_report(&self) -> bool {
        false
    }

    /// Asks where to write the report.
    fn save_report(&self, _workspace: &mut Workspace) {}

    /// Undoes a change of what it shows.
    fn undo(&mut self, _workspace: &mut Workspace) {}

    /// Does again what was undone.
    fn redo(&mut self, _workspace: &mut Workspace) {}

    /// Explains its controls.
    fn help() -> Help
    where
        Self: Sized;
}

/// Declares `Views`, the states of a platform's views in the order of their tabs.
macro_rules! views {
    ($($name:ident: $field:ident = $state:ty;)+) => {
        /// The states of all views.
        #[derive(Debug, Default)]
        #[expect(missing_docs, reason = "each has the name of its view")]
        pub struct Views {
            $(pub $field: $state,)+
        }

        impl Views {
            /// The views, in the order of their tabs.
            pub const NAMES: &[socam_workbench::View] = &[$(socam_workbench::View::$name),+];

            /// Explains the controls of a view.
            #[must_use]
            pub fn help(view: socam_workbench::View) -> $crate::Help {
                $(if view == socam_workbench::View::$name {
                    return <$state as $crate::ViewPanel>::help();
                })+
                &[]
            }

            /// The state of a view. One that this platform lacks is replaced by the view over time.
            pub(crate) fn peek(&self, view: socam_workbench::View) -> &dyn $crate::ViewPanel {
                $(if view == socam_workbench::View::$name {
                    return &self.$field;
                })+
                &self.time
            }

            /// The state of a view, to change it.
            pub(crate) fn get(&mut self, view: socam_workbench::View) -> &mut dyn $crate::ViewPanel {
                $(if view == socam_workbench::View::$name {
                    return &mut self.$field;
                })+
                &mut self.time
            }

            pub(crate) fn is_busy(&self) -> bool {
                Self::NAMES.iter().any(|view| self.peek(*view).is_busy())
            }
        }
    };
}
pub(crate) use views;
