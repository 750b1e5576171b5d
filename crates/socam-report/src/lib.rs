//! Pages and pictures of results: HTML and SVG from the documents of other crates, which do not know of this one.
//!
//! | module | from | to |
//! |---|---|---|
//! | [`diagnosis`] | `socam.diagnosis/1` with its evidence | a folder with a page, the document and the corrected model |
//! | `comparison` | a comparison of a recording with a simulation | a page |
//! | `fleet` | the summary of a fleet's table | a page |
//! | `response` | frequency responses and transfer functions | a page, and its pictures |
//! | `thesis` | the numbers of the thesis | a page |
//! | [`mod@bench`] | a model | a drawing |
//! | `calibration`, `efficiency` | lines through pairs, losses | a picture |
//!
//! All modules but [`diagnosis`] and [`mod@bench`] are features of the same name. Every page is one self-contained file without scripts, in light and
//! dark colours. Pages are text; only [`diagnosis::write`] writes files.

pub mod bench;
#[cfg(feature = "calibration")]
pub mod calibration;
#[cfg(feature = "comparison")]
pub mod comparison;
pub mod diagnosis;
#[cfg(feature = "efficiency")]
pub mod efficiency;
#[cfg(feature = "fleet")]
pub mod fleet;
mod provenance;
#[cfg(feature = "response")]
pub mod response;
mod scaffold;
#[cfg(feature = "thesis")]
pub mod thesis;

pub use provenance::{FileHash, Provenance};
