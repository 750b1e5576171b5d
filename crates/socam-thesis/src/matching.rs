//! Section 4.2: coefficient matching; points 5 to 9 and 18 to 20.

mod constants;
mod equations;
mod solutions;
mod transfer_function;

use crate::{Thesis, report::Report};
use constants::{characteristic, coefficients, constants, weights};
use equations::Printed47;
use solutions::{couplings, scale, solutions};
use transfer_function::{identifiability, poles, properly};

pub(crate) fn examine(thesis: &Thesis, report: &mut Report) {
    let equations = Printed47::new(thesis);
    characteristic(thesis, report);
    constants(thesis, report, &equations);
    coefficients(thesis, report, &equations);
    weights(thesis, report, &equations);
    solutions(thesis, report, &equations);
    couplings(thesis, report);
    scale(thesis, report, &equations);
    poles(thesis, report);
    identifiability(thesis, report);
    properly(thesis, report);
}
