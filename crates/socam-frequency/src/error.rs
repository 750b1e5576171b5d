//! Errors of estimation.

use thiserror::Error;

/// Why there is no estimate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FrequencyError {
    /// Signals of one segment differ in length.
    #[error("a stretch has {input} input samples and {output} output samples; they must be as many")]
    Lengths {
        /// Input samples.
        input: usize,
        /// Output samples.
        output: usize,
    },
    /// The recordings have no excitation within the band.
    #[error(
        "no line between {from_hz} and {to_hz} Hz is excited; record a multisine, a chirp or a prbs, or widen the band"
    )]
    NotExcited {
        /// Lower end, Hz.
        from_hz: f64,
        /// Upper end, Hz.
        to_hz: f64,
    },
    /// The segments are too short.
    #[error(
        "the longest stretch without a gap has {rows} samples; a frequency response needs at least {needed}"
    )]
    TooShort {
        /// Samples of the longest segment.
        rows: usize,
        /// Least number of samples.
        needed: usize,
    },
    /// Fewer data than unknowns.
    #[error(
        "{lines} lines of the response do not determine {unknowns} coefficients; take lower orders or a wider band"
    )]
    TooFewLines {
        /// Lines with a response.
        lines: usize,
        /// Coefficients asked for.
        unknowns: usize,
    },
    /// More zeros than poles.
    #[error(
        "a numerator of order {numerator} over a denominator of order {denominator}: the latter must be the greater, and 1 to 12"
    )]
    Orders {
        /// Order of the numerator.
        numerator: usize,
        /// Order of the denominator.
        denominator: usize,
    },
    /// A filter that does not exist.
    #[error(
        "a Butterworth filter of order {order} at {corner_hz} Hz: the order must be 1 to 10 and the corner between 0 and half the sampling rate of {rate_hz} Hz"
    )]
    Filter {
        /// Order of the filter.
        order: usize,
        /// Corner frequency, Hz.
        corner_hz: f64,
        /// Sampling rate, Hz.
        rate_hz: f64,
    },
    /// A linear system without a solution.
    #[error("{what} has no unique solution on these data")]
    Singular {
        /// The problem to solve.
        what: &'static str,
    },
}
