//! Errors of the libraries as exceptions of the package, each with its sentence.

use pyo3::PyErr;
use pyo3::exceptions::{PyTypeError, PyValueError};
use socam_job::JobError;

pyo3::import_exception!(socam.errors, SocamError);
pyo3::import_exception!(socam.errors, RecordingError);
pyo3::import_exception!(socam.errors, ModelError);
pyo3::import_exception!(socam.errors, FitError);
pyo3::import_exception!(socam.errors, SimulationError);

/// An error of a library that this package raises as an exception.
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
    socam_model::ModelError => ModelError,
    socam_report::diagnosis::ReportError => SocamError,
    socam_fleet::FleetError => SocamError,
    serde_json::Error => SocamError,
}

impl Raised for JobError {
    fn raised(self) -> PyErr {
        let sentence = self.in_keywords();
        match self {
            Self::Keyword(_) => PyTypeError::new_err(sentence),
            Self::Value { .. } | Self::Inputs(_) | Self::File(_) => PyValueError::new_err(sentence),
            Self::Change { .. }
            | Self::NoModel { .. }
            | Self::Read { .. }
            | Self::ModelFile { .. }
            | Self::Description(_)
            | Self::Model(_) => ModelError::new_err(sentence),
            Self::Recording(_) | Self::Import(_) | Self::Compare(_) => RecordingError::new_err(sentence),
            Self::Simulation(_) | Self::Design(_) => SimulationError::new_err(sentence),
            Self::OtherModel { .. }
            | Self::Identify(_)
            | Self::Steady(_)
            | Self::Diagnose(_)
            | Self::Monitor(_)
            | Self::Response(_) => FitError::new_err(sentence),
        }
    }
}
