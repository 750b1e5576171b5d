//! `identify --method coefficient-match`: the thesis' method and a direct fit to the same data.

mod source;

use std::fmt::Write as _;

use serde_json::{Value, json};
use socam_frequency::{
    chebyshev::economise,
    matching::{self, Bench, BenchEquations, Direct, Equations, Matched, NAMES, UNKNOWNS},
    rational::{Point, TransferFunction},
};
use socam_model::Model;
use socam_report::response::{self, Section};

use super::Args;
use crate::{commands::Outcome, output, table};
use source::{Data, ORDERS, data, thesis_bench};

const SCHEMA: &str = "socam.coefficient-match/1";
/// Greatest relative error of a matched coefficient.
const HOLDS: f64 = 0.01;
/// Greatest relative standard deviation of a determined parameter: the half-width of its interval is half the value.
const DETERMINED: f64 = 0.5 / 1.96;

/// Values below this are shown as 0, and values above its inverse as infinite: the search diverged.
const NEXT_TO_NOTHING: f64 = 1e-9;
/// Greatest relative standard deviation that is shown as a number.
const SHOWN_STD: f64 = 10.0;

/// Results of both weightings and of the direct fit.
struct Answer {
    source: String,
    bench: Bench,
    points: Vec<Point>,
    transfer: TransferFunction,
    economised_bound: Option<f64>,
    names: Vec<String>,
    matched: Vec<(&'static str, Matched, Vec<f64>)>,
    direct: Direct,
}

pub(super) fn run(args: &Args, model: &Model) -> anyhow::Result<Outcome> {
    let (bench, start) = thesis_bench(model)?;
    let Data { source, transfer: whole, points, outcome } = data(args, model)?;
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
    let answer =
        Answer { source, bench, points, transfer, economised_bound, names, matched: matched.into(), direct };
    let document = answer.json(model);
    if let Some(dir) = &args.report {
        output::write_folder(dir, &answer.files(model, &document)?)?;
    }
    if args.json {
        output::print_json(&document)?;
    } else {
        output::print(&answer.text(model))?;
    }
    Ok(outcome)
}

impl Answer {
    /// Coefficients that no choice of parameters matches, one sentence each.
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
            // Coefficients of the wrong sign are reported above.
            let misses = self
                .names
                .iter()
                .zip(ratios)
                .filter(|(_, ratio)| **ratio > 0.0 && (*ratio - 1.0).abs() > HOLDS);
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

    /// Parameters and combinations by both weightings and the direct fit; the first row is the header.
    fn table(&self) -> Vec<Vec<String>> {
        let mut head = vec![String::new()];
        head.extend(self.matched.iter().map(|(weights, ..)| format!("weights {weights}")));
        head.extend(["direct fit", "its std", "unit", ""].map(str::to_owned));
        let mut rows = vec![head];
        let row = |name: &str, values: Vec<f64>, std: Option<f64>, unit: &str, note: String| {
            let mut row = vec![name.to_owned()];
            row.extend(values.into_iter().map(|value| match value.abs() {
                size if size < NEXT_TO_NOTHING => "0".into(),
                size if size > 1.0 / NEXT_TO_NOTHING => "no end".into(),
                _ => table::number(value),
            }));
            let std = std.map_or_else(String::new, |std| {
                if std > SHOWN_STD { "over 1000 %".into() } else { format!("{:.1} %", 100.0 * std) }
            });
            row.extend([std, unit.to_owned(), note]);
            row
        };
        for (i, name) in NAMES.iter().enumerate() {
            let found = self.matched.iter().map(|(_, found, _)| found.at[i]);
            let std = self.direct.relative_std[i];
            let judged = if std <= DETERMINED { "" } else { "not determined" };
            let unit = if i < 4 { "N m/rad" } else { "N m s/rad" };
            rows.push(row(name, found.chain([self.direct.at[i]]).collect(), Some(std), unit, judged.into()));
        }
        let of: Vec<_> = self.matched.iter().map(|(_, found, _)| matching::combinations(&found.at)).collect();
        for (i, own) in matching::combinations(&self.direct.at).into_iter().enumerate().take(4) {
            let values = of.iter().map(|all| all[i].value).chain([own.value]).collect();
            let std = (i == 0).then_some(self.direct.series_relative_std);
            rows.push(row(own.name, values, std, own.unit, format!("= {}", own.expression)));
        }
        rows
    }

    /// Reason for which each search ended, one sentence each.
    fn ends(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        if let Some(bound) = self.economised_bound {
            sentences.push(format!(
                "numerator economised to s^3 on [-1, 1] 1/s: off by at most {bound:.3e} there, and by anything beyond"
            ));
        }
        for (weights, found, _) in &self.matched {
            let most = found.relative_gradient.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
            let gradient = match found.gradient_check {
                None => "the equations hold to rounding".into(),
                Some(0.0) => {
                    format!("gradient left {most:.1e} of it, as differences of f give it to their rounding")
                }
                Some(off) => format!(
                    "gradient left {most:.1e} of it, {off:.1e} of its largest entry off differences of f"
                ),
            };
            sentences.push(format!(
                "weights {weights}: f = {:.4e} after {} quadratic programmes{}; {gradient}",
                found.cost,
                found.steps,
                if found.converged { "" } else { " (not at rest)" },
            ));
        }
        sentences
            .push(format!("direct fit misses the response by {:.2} of its deviations", self.direct.misfit));
        sentences
    }

    fn text(&self, model: &Model) -> String {
        let mut text = format!("{} by coefficient-match with {}\n", model.name, self.source);
        text.push_str(&table::align(&self.table(), &[false, true, true, true, true, false, false]));
        for sentence in self.ends() {
            let _ = writeln!(text, "  {sentence}");
        }
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

    /// The page, its pictures and the numbers.
    fn files(&self, model: &Model, document: &Value) -> anyhow::Result<Vec<(String, String)>> {
        let mut fits: Vec<(String, TransferFunction)> = self
            .matched
            .iter()
            .map(|(weights, found, _)| ((*weights).to_owned(), self.bench.transfer(&found.at)))
            .collect();
        fits.push(("direct fit".into(), self.bench.transfer(&self.direct.at)));
        let drawn = response::matched(&fits, &self.points);
        let mut files =
            vec![("match.json".to_owned(), format!("{}\n", serde_json::to_string_pretty(document)?))];
        files.extend(drawn.iter().map(|p| (format!("{}.svg", p.name), p.svg())));
        let section = |title: &str, sentences: Vec<String>, pictures, tables| {
            let sentences = sentences.iter().map(|text| sentence(text)).collect();
            Section { title: title.into(), sentences, pictures, tables }
        };
        let found = section("Parameters", self.ends(), drawn, vec![self.table()]);
        let cannot = match self.cannot_hold() {
            none if none.is_empty() => vec!["every coefficient holds to 1 %".to_owned()],
            sentences => sentences,
        };
        let sections = [found, section("What cannot hold", cannot, Vec::new(), Vec::new())];
        let title = format!("Coefficients of {} matched", model.name);
        files.push((
            "index.html".to_owned(),
            response::page(&title, &format!("From {}.", self.source), &sections),
        ));
        Ok(files)
    }
}

/// Turns a line of the terminal into a sentence of a page.
fn sentence(line: &str) -> String {
    let mut letters = line.chars();
    letters.next().map_or_else(String::new, |first| format!("{}{}.", first.to_uppercase(), letters.as_str()))
}
