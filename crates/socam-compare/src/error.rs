//! Errors, each of one sentence.

/// The result of this crate.
pub type Result<T, E = CompareError> = std::result::Result<T, E>;

/// Why two recordings cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// No channel is in both.
    #[error(
        "`{recording}` and `{simulation}` have no channel of the same name and unit: one has {measured}, the other {simulated}; name pairs with --map SIMULATED=MEASURED"
    )]
    NoCommonChannel {
        /// Name of the recording.
        recording: String,
        /// Name of the simulation.
        simulation: String,
        /// Columns of the recording.
        measured: String,
        /// Columns of the simulation.
        simulated: String,
    },
    /// A channel that was named does not exist.
    #[error("--map {map}: `{file}` has no channel `{channel}`; it has {available}")]
    NoSuchChannel {
        /// The argument.
        map: String,
        /// The file without it.
        file: String,
        /// The channel.
        channel: String,
        /// What the file has.
        available: String,
    },
    /// Two channels of different units.
    #[error("--map {map}: one is in {simulated}, the other in {measured}; convert one of them")]
    Units {
        /// The argument.
        map: String,
        /// Unit of the simulated channel.
        simulated: String,
        /// Unit of the measured channel.
        measured: String,
    },
    /// No common time.
    #[error(
        "`{recording}` runs from {from_s} s to {to_s} s and `{simulation}` from {sim_from_s} s to {sim_to_s} s: they have fewer than {least} rows in common; give a simulation of the same time"
    )]
    NoOverlap {
        /// Name of the recording.
        recording: String,
        /// Its first time.
        from_s: f64,
        /// Its last time.
        to_s: f64,
        /// Name of the simulation.
        simulation: String,
        /// Its first time.
        sim_from_s: f64,
        /// Its last time.
        sim_to_s: f64,
        /// Fewest rows that can be compared.
        least: usize,
    },
    /// A recording that cannot be read.
    #[error(transparent)]
    Recording(#[from] socam_recording::RecordingError),
}
