//! Errors of the libraries as exceptions of the package, each with its sentence.

use pyo3::PyErr;

pyo3::import_exception!(socam.errors, SocamError);
pyo3::import_exception!(socam.errors, RecordingError);
pyo3::import_exception!(socam.errors, ModelError);
pyo3::import_exception!(socam.errors, FitError);
pyo3::import_exception!(socam.errors, SimulationError);

/// An error that a caller of this package meets as an exception.
pub(crate) trait Raised {
    fn raised(self) -> PyErr;
}

/// `error: Type => Exception`
macro_rules! raised {
    ($($error:ty => $exception:ident,)*) => {
        $(impl Raised for $error {
            fn raised(self) -> PyErr {
                $exception::new_err(self.to_string())
            }
        })*
    };
}

raised! {
    socam_import::ImportError => RecordingError,
    socam_recording::RecordingError => RecordingError,
    socam_recording::SettingsError => SocamError,
    socam_model::ModelError => ModelError,
    socam_identify::IdentifyError => FitError,
    socam_compare::CompareError => RecordingError,
    socam_response::ResponseError => FitError,
    socam_watch::WatchError => FitError,
    socam_diagnose::DiagnoseError => FitError,
    socam_report::diagnosis::ReportError => SocamError,
    socam_design::DesignError => SimulationError,
    socam_fleet::FleetError => SocamError,
    socam_sim::SimError => SimulationError,
    serde_json::Error => SocamError,
}
