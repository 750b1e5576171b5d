//! The views of the desktop.

use super::diagnose::Diagnose;
use super::fleet::FleetView;
use super::identify::Identify;
use super::live::Live;
use super::watch::WatchView;
use crate::check::Checks;
use crate::machine::MachineView;
use crate::review::Review;
use crate::spectra::Spectra;
use crate::view::views;

views! {
    Live: live = Live;
    Time: time = Review;
    Frequency: frequency = Spectra;
    Check: check = Checks;
    Identify: identify = Identify;
    Diagnosis: diagnosis = Diagnose;
    Watch: watch = WatchView;
    Fleet: fleet = FleetView;
    Machine: machine = MachineView;
}

impl Views {
    /// Brings what to record next into sight.
    pub(crate) fn seek_next(&mut self) {
        self.diagnosis.page.seek_next();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_desktop_has_every_view() {
        assert_eq!(Views::NAMES, socam_workbench::View::ALL);
    }
}
