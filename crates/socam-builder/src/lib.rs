//! A model file from a short description: what a machine consists of, what drives it, what is measured.
//!
//! [`describe`] reads a chain of parts (`motor 0.9kgcm2 | coupling 800Nm/rad | gear 5 | load disc 4kg 200mm`), a drive
//! (`torque@motor:motor_current_A*0.055`) and measurements (`speed@load`), and returns the text of a model file. Each parameter says where
//! its start value comes from: from the description, from sizes, from what is usual, or from a recording. The stages are `words` (numbers
//! with units), `part` (one part of the chain), `sizes` (formulas and usual values), `machine` (nodes and links), `channels`, `start`
//! (start values from a recording) and `file` (the text).
//!
//! ```
//! use socam_builder::{Description, describe};
//! use socam_model::Model;
//!
//! let described = describe(
//!     &Description {
//!         name: "axis",
//!         chain: "motor 0.9kgcm2 | coupling 800Nm/rad | load disc 4kg 200mm",
//!         drives: &["torque@motor:motor_current_A*0.055".to_owned()],
//!         measures: &["speed@motor".to_owned(), "speed@load".to_owned()],
//!     },
//!     None,
//! )?;
//! let model = Model::parse(&described.text).expect("a model file");
//! assert_eq!(model.nodes.len(), 2);
//! // Half of mass times radius squared.
//! assert_eq!(model.parameters[model.parameter("load_inertia").unwrap()].value, 0.02);
//! # Ok::<(), socam_builder::DescribeError>(())
//! ```

mod channels;
mod drawing;
mod file;
mod fixed;
mod machine;
mod part;
mod sizes;
mod spec;
mod start;
#[cfg(test)]
mod tests;
mod words;

pub use drawing::{draw, legend};
use socam_model::Model;
use socam_recording::Dataset;
use thiserror::Error;

/// The grammar of a chain, for help texts.
pub const GRAMMAR: &str = "\
Parts, from the motor to the load, separated by `|`; sizes in any order, each with its unit:
  motor 0.9kgcm2 0.055Nm/A 1.2ohm      rotor inertia; torque constant, resistance, inductance (mH)
  coupling 800Nm/rad                   or: coupling jaw, coupling bellows, coupling rigid
  shaft 20x300mm steel                 diameter x length; or 5kNm/rad, or: shaft rigid
  sensor 5kNm/rad                      a torque sensor
  gear 5                               slower 5 times; also gear 5:1, gear 20:100 teeth, gear 50 8kNm/rad
  belt 20:60 span 400mm width 15mm     teeth of both pulleys, or radii: belt 16:48mm span 400mm
  screw 5mm                            lead; also rack 120mm (travel per turn), screw 5mm 80N/um
  slide 12kg                           behind a screw or a rack; at the beginning: a linear axis
  load 0.02kgm2                        or disc 4kg 200mm (diameter), rod 2kg 500mm (length), 2kg 300mm (radius)
  inertia 0.5kgcm2                     a flange, a flywheel, a pulley
A name may stand before a part: `front: coupling jaw`. What has no size gets a usual one with wide bounds.
Drive and measurements are QUANTITY@PART[:COLUMN[*SCALE][ UNIT]]: torque@motor:current_A*0.055, speed@load:tacho_1 rpm.
  drive    torque, force, current, voltage, speed, position (a servo, the column is its reference)
  measure  speed, angle, position, acceleration; torque through a coupling, shaft, belt or sensor; current";

/// A user's description of a machine.
#[derive(Debug, Clone, Copy)]
pub struct Description<'d> {
    /// Name of the model.
    pub name: &'d str,
    /// Parts of the machine, see [`GRAMMAR`].
    pub chain: &'d str,
    /// Drives of the machine, at least one.
    pub drives: &'d [String],
    /// Measured channels, at least one.
    pub measures: &'d [String],
}

/// A model file, and what the user should know of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Described {
    /// Text of the model file; it is a model.
    pub text: String,
    /// Sentences on start values that the recording gave or could not give.
    pub notes: Vec<String>,
}

/// Why a description gives no model: one sentence.
#[derive(Debug, Error)]
pub enum DescribeError {
    /// A part, a drive or a measurement that is not understood.
    #[error("`{text}`: {problem}")]
    Text {
        /// Text in which the mistake is.
        text: String,
        /// Explanation: what is wrong with the text, and what to write.
        problem: String,
    },
    /// The parts do not make a machine.
    #[error("{0}")]
    Machine(String),
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(#[from] socam_recording::RecordingError),
}

impl DescribeError {
    fn text(text: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Text { text: text.into(), problem: problem.into() }
    }
}

/// Writes the model file of a description. Columns and start values come from `recording`, where one is given.
///
/// # Errors
/// [`DescribeError`] with the words that are not understood and what to write instead.
pub fn describe(
    description: &Description<'_>,
    recording: Option<&Dataset>,
) -> Result<Described, DescribeError> {
    let mut machine = machine::Machine::build(description.chain)?;
    let columns = recording.map(channels::columns);
    machine.connect(description.drives, description.measures, columns.as_deref())?;
    let model = |text: &str| {
        Model::parse(text).map_err(|error| {
            DescribeError::Machine(format!("this description gives no model, because in its file {error}"))
        })
    };
    let text = file::write(description, &machine);
    let described = model(&text)?;
    let Some(data) = recording else { return Ok(Described { text, notes: Vec::new() }) };
    let notes = start::from_recording(&mut machine, &described, data)?;
    let text = file::write(description, &machine);
    model(&text)?;
    Ok(Described { text, notes })
}

/// The columns of a recording that can be channels.
///
/// ```
/// # use socam_recording::{Channel, Dataset, Unit};
/// let columns = vec![Channel::new("motor_speed", Unit::RadPerS)];
/// let data = Dataset::from_columns("run", columns, vec![0.0, 0.001], vec![vec![0.0, 1.0]])?;
/// assert_eq!(socam_builder::columns(&data), ["motor_speed_rad_s"]);
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
#[must_use]
pub fn columns(recording: &Dataset) -> Vec<String> {
    channels::columns(recording)
}
