//! The views of a page: those that only read.

use crate::check::Checks;
use crate::diagnosis::DiagnosisPage;
use crate::identification::IdentificationPage;
use crate::machine::MachineView;
use crate::review::Review;
use crate::spectra::Spectra;
use crate::view::views;

views! {
    Time: time = Review;
    Frequency: frequency = Spectra;
    Check: check = Checks;
    Identify: identify = IdentificationPage;
    Diagnosis: diagnosis = DiagnosisPage;
    Machine: machine = MachineView;
}

impl Views {
    /// Brings what to record next into sight.
    pub(crate) fn seek_next(&mut self) {
        self.diagnosis.seek_next();
    }
}
