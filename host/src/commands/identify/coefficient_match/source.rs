//! Data of the matching: the bench of the model, and a transfer function with points of its response.

use std::path::Path;

use socam_frequency::{
    Complex,
    matching::{Bench, NAMES, UNKNOWNS},
    rational::{self, Orders, Point, TransferFunction},
};
use socam_model::Model;

use crate::commands::{
    Outcome,
    identify::{Args, etf, files},
};
use crate::output::WrongArguments;

/// The model's orders.
pub(super) const ORDERS: Orders = Orders { numerator: 3, denominator: 6 };

/// The thesis' bench in the model, and the start values.
pub(super) fn thesis_bench(model: &Model) -> anyhow::Result<(Bench, [f64; UNKNOWNS])> {
    let refuse = || {
        WrongArguments(format!(
            "--method coefficient-match knows the bench of the thesis only, and the model {} is another; use --method output-error",
            model.name
        ))
    };
    let value =
        |name: &str| model.parameter(name).map(|index| model.parameters[index].value).ok_or_else(refuse);
    let bench = Bench { cam_shaft: value("J2")?, disk: value("J3")?, load: value("J4")?, ratio: value("N")? };
    let mut at = [0.0; UNKNOWNS];
    for (own, name) in at.iter_mut().zip(NAMES) {
        *own = value(name)?;
    }
    let equations = model.equations(&model.values())?;
    let output = model.outputs().position(|channel| channel.name == "output_speed").ok_or_else(refuse)?;
    let transfer = bench.transfer(&at);
    for s in [Complex::new(0.0, 10.0), Complex::new(-5.0, 300.0)] {
        let exact = equations.transfer(output, 0, s).ok_or_else(refuse)?;
        if (transfer.at(s) - exact).norm() > 1e-6 * exact.norm() {
            return Err(refuse().into());
        }
    }
    Ok((bench, at))
}

/// The transfer function to match, and points for the direct fit.
pub(super) struct Data {
    /// Origin of the transfer function.
    pub(super) source: String,
    pub(super) transfer: TransferFunction,
    pub(super) points: Vec<Point>,
    /// Whether the recordings are whole.
    pub(super) outcome: Outcome,
}

/// Reads a transfer function, or fits one to recordings.
pub(super) fn data(args: &Args, model: &Model) -> anyhow::Result<Data> {
    if let [only] = &args.runs[..] {
        let named =
            if only == "thesis" { Some(thesis_etf()?) } else { files::transfer_file(Path::new(only))? };
        if let Some(transfer) = named {
            let points = points_of(&transfer, args);
            return Ok(Data { source: only.clone(), transfer, points, outcome: Outcome::Done });
        }
    }
    let measured = etf::measured(args, model)?;
    let orders = args.task.orders.unwrap_or(ORDERS);
    let fit = rational::fit(&measured.points, orders, args.task.stable)?;
    let source = args.runs.join(", ");
    Ok(Data { source, transfer: fit.transfer, points: measured.points, outcome: measured.outcome })
}

/// The transfer function that the thesis measured.
fn thesis_etf() -> anyhow::Result<TransferFunction> {
    let thesis = socam_thesis::thesis().map_err(anyhow::Error::msg)?;
    let ascending = |printed: &[socam_thesis::Printed]| printed.iter().rev().map(|p| p.value).collect();
    Ok(TransferFunction {
        numerator: ascending(&thesis.transfer.numerator),
        denominator: ascending(&thesis.transfer.denominator),
    })
}

/// A transfer function's response as a measurement known to 1 %.
fn points_of(transfer: &TransferFunction, args: &Args) -> Vec<Point> {
    let [low, high] = args.task.band.map_or([0.5, 100.0], |band| [band.low_hz(), band.high_hz()]);
    transfer.measured([low, high], 120, 0.01)
}
