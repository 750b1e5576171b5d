//! `identify --method coefficient-match`: the thesis' method, and beside it what a direct fit makes of the same data.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};
use socam_frequency::{
    Complex,
    chebyshev::economise,
    matching::{self, Bench, BenchEquations, Direct, Equations, Matched, NAMES, UNKNOWNS},
    rational::{self, Orders, Point, TransferFunction},
};
use socam_model::Model;

use super::{Args, etf};
use crate::{
    commands::Outcome,
    output::{self, WrongArguments},
    table,
};

const SCHEMA: &str = "socam.coefficient-match/1";
/// The model's orders.
const ORDERS: Orders = Orders { numerator: 3, denominator: 6 };
/// A coefficient that the model misses by more than this share does not hold.
const HOLDS: f64 = 0.01;
/// An interval's half-width of at most half the value determines a parameter: this relative standard deviation.
const DETERMINED: f64 = 0.5 / 1.96;

/// Both weightings and the direct fit.
struct Answer {
    source: String,
    transfer: TransferFunction,
    economised_bound: Option<f64>,
    names: Vec<String>,
    matched: Vec<(&'static str, Matched, Vec<f64>)>,
    direct: Direct,
}

pub(super) fn run(args: &Args, model: &Model) -> anyhow::Result<Outcome> {
    let (bench, start) = thesis_bench(model)?;
    let (source, whole, points) = data(args, model)?;
    let cut = economise(&whole.numerator, ORDERS.numerator);
    let economised_bound = (whole.numerator.len() > ORDERS.numerator + 1).then_some(cut.bound);
    let transfer = TransferFunction { numerator: cut.coefficients, denominator: whole.denominator };
    if transfer.denominator.len() != ORDERS.denominator + 1 {
        let order = transfer.denominator.len() - 1;
        anyhow::bail!(
            "the transfer function of {source} is of order {order}; this bench's is of order 6, so fit it with --orders 3/6"
        );
    }
    let equations = bench.equations(&transfer);
    let phi = equations.errors(&start);
    let size = |error: &f64| error.abs().max(1e-9);
    let weightings: [(&str, Vec<f64>); 2] = [
        ("1/phi(x0)^2", phi.iter().map(|error| size(error).powi(-2)).collect()),
        ("1/|phi(x0)|", phi.iter().map(|error| size(error).recip()).collect()),
    ];
    let matched = weightings.map(|(name, weights)| {
        let found = matching::solve(&equations, &weights, &start);
        let ratios = equations.ratios(&found.at);
        (name, found, ratios)
    });
    let direct = matching::direct(&bench, &points, &start);
    let names = BenchEquations::names(&equations);
    let answer = Answer { source, transfer, economised_bound, names, matched: matched.into(), direct };
    if args.json {
        output::print_json(&answer.json(model))?;
    } else {
        output::print(&answer.text(model))?;
    }
    Ok(Outcome::Done)
}

/// The thesis' bench out of the model, and where to start.
fn thesis_bench(model: &Model) -> anyhow::Result<(Bench, [f64; UNKNOWNS])> {
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
fn data(args: &Args, model: &Model) -> anyhow::Result<(String, TransferFunction, Vec<Point>)> {
    if let [only] = &args.runs[..] {
        let named = if only == "thesis" { Some(thesis_etf()?) } else { etf::transfer_file(Path::new(only))? };
        if let Some(transfer) = named {
            let points = points_of(&transfer, args);
            return Ok((only.clone(), transfer, points));
        }
    }
    let measured = etf::measured(args, model)?;
    let orders = args.frequency.orders.unwrap_or(ORDERS);
    let fit = rational::fit(&measured.points, orders, args.frequency.stable)?;
    Ok((args.runs.join(", "), fit.transfer, measured.points))
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
    let [low, high] = args.band.map_or([0.5, 100.0], |band| [band.low_hz(), band.high_hz()]);
    (0..120)
        .map(|i| {
            let frequency_hz = low * (high / low).powf(f64::from(i) / 119.0);
            let output = transfer.response(frequency_hz);
            Point { frequency_hz, input: Complex::new(1.0, 0.0), output, std: 0.01 * output.norm() }
        })
        .collect()
}

impl Answer {
    /// What no choice of the parameters meets, one sentence each.
    fn cannot_hold(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        let negative = |coefficients: &[f64], part: &str| -> Vec<String> {
            let signs = coefficients.iter().enumerate().filter(|(_, c)| **c < 0.0);
            signs
                .map(|(i, c)| {
                    format!("{part} s^{i} is {c:.4e}; positive stiffnesses and dampings make it positive")
                })
                .collect()
        };
        sentences.extend(negative(&self.transfer.numerator, "numerator"));
        sentences.extend(negative(&self.transfer.denominator, "denominator"));
        if let Some((_, _, ratios)) = self.matched.first() {
            let misses = self.names.iter().zip(ratios).filter(|(_, ratio)| (*ratio - 1.0).abs() > HOLDS);
            sentences
                .extend(misses.map(|(name, ratio)| {
                    format!("{name}: the best match is {ratio:.4} of the measured one")
                }));
        }
        sentences
    }

    fn json(&self, model: &Model) -> Value {
        let combinations = |at: &[f64; UNKNOWNS]| -> Vec<Value> {
            let entry = |c: matching::Combination| json!({"name": c.name, "expression": c.expression, "unit": c.unit, "value": c.value});
            matching::combinations(at).into_iter().map(entry).collect()
        };
        let parameters = |at: &[f64; UNKNOWNS]| {
            NAMES.iter().zip(at).map(|(n, v)| ((*n).to_owned(), json!(v))).collect::<serde_json::Map<_, _>>()
        };
        let matched = self.matched.iter().map(|(weights, found, ratios)| {
            json!({
                "weights": weights, "converged": found.converged, "programmes": found.steps, "cost": found.cost,
                "parameters": parameters(&found.at), "combinations": combinations(&found.at),
                "gradient": found.gradient, "relative_gradient": found.relative_gradient, "gradient_check": found.gradient_check,
                "singular_values": found.singular_values,
                "coefficients": self.names.iter().zip(ratios).map(|(n, r)| json!({"name": n, "ratio": r})).collect::<Vec<_>>(),
            })
        });
        let finite = |value: f64| value.is_finite().then_some(value);
        json!({
            "schema": SCHEMA, "method": "coefficient-match", "model": model.name, "source": self.source,
            "numerator": self.transfer.numerator, "denominator": self.transfer.denominator,
            "economised_bound": self.economised_bound, "matched": matched.collect::<Vec<_>>(),
            "cannot_hold": self.cannot_hold(),
            "direct": {
                "converged": self.direct.converged, "misfit": finite(self.direct.misfit),
                "parameters": NAMES.iter().enumerate().map(|(i, name)| json!({
                    "name": name, "value": self.direct.at[i], "relative_std": finite(self.direct.relative_std[i]),
                    "determined": self.direct.relative_std[i] <= DETERMINED,
                })).collect::<Vec<_>>(),
                "combinations": combinations(&self.direct.at), "k_series_relative_std": finite(self.direct.series_relative_std),
            },
        })
    }

    fn text(&self, model: &Model) -> String {
        let mut text = format!("{} by coefficient-match with {}\n", model.name, self.source);
        if let Some(bound) = self.economised_bound {
            let _ = writeln!(
                text,
                "  numerator economised to s^3 on [-1, 1] 1/s: off by at most {bound:.3e} there, and by anything beyond"
            );
        }
        let mut head = vec![String::new()];
        head.extend(self.matched.iter().map(|(weights, ..)| format!("weights {weights}")));
        head.extend(["direct fit", "its std", "unit", ""].map(str::to_owned));
        let mut rows = vec![head];
        let combined: Vec<_> =
            self.matched.iter().map(|(_, found, _)| matching::combinations(&found.at)).collect();
        let direct = matching::combinations(&self.direct.at);
        for (i, name) in NAMES.iter().enumerate() {
            let mut row = vec![(*name).to_owned()];
            row.extend(self.matched.iter().map(|(_, found, _)| table::number(found.at[i])));
            let std = self.direct.relative_std[i];
            let judged = if std <= DETERMINED { "" } else { "not determined" };
            let unit = if i < 4 { "N m/rad" } else { "N m s/rad" };
            row.extend([
                table::number(self.direct.at[i]),
                format!("{:.1} %", 100.0 * std),
                unit.into(),
                judged.into(),
            ]);
            rows.push(row);
        }
        for (i, combination) in direct.iter().enumerate().take(4) {
            let mut row = vec![combination.name.to_owned()];
            row.extend(combined.iter().map(|own| table::number(own[i].value)));
            let std = if i == 0 {
                format!("{:.1} %", 100.0 * self.direct.series_relative_std)
            } else {
                String::new()
            };
            row.extend([
                table::number(combination.value),
                std,
                combination.unit.into(),
                format!("= {}", combination.expression),
            ]);
            rows.push(row);
        }
        text.push_str(&table::align(&rows, &[false, true, true, true, true, false, false]));
        for (weights, found, _) in &self.matched {
            let most = found.relative_gradient.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
            let _ = writeln!(
                text,
                "  weights {weights}: f = {:.4e} after {} quadratic programmes{}; gradient left {most:.1e}, beside differences {:.1e}",
                found.cost,
                found.steps,
                if found.converged { "" } else { " (not at rest)" },
                found.gradient_check
            );
        }
        let _ =
            writeln!(text, "  direct fit misses the response by {:.2} of its deviations", self.direct.misfit);
        let cannot = self.cannot_hold();
        if cannot.is_empty() {
            text.push_str("  every coefficient holds to 1 %\n");
        } else {
            text.push_str("\nWhat cannot hold\n");
            cannot.iter().for_each(|sentence| {
                let _ = writeln!(text, "  {sentence}");
            });
        }
        text
    }
}
