//! `identify --method etf`: a transfer function from recordings or from a frequency response.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::Context;
use serde_json::{Value, json};
use socam_frequency::{
    Complex,
    rational::{self, Fit, Orders, Point},
    response::{self, Line},
};
use socam_job::Grid;
use socam_model::{Model, Quantity};
use socam_report::response::{self as report, Section};
use socam_response::Beside;

use super::{
    Args,
    files::{SCHEMA, response_file},
    frf,
};
use crate::{
    commands::Outcome,
    output::{self, WrongArguments},
    table,
};

/// Highest order that is tried if none is given: that of the thesis.
const HIGHEST: usize = 6;
/// Orders that are shown of those tried.
const SHOWN: usize = 6;

/// Ratio of a mode's frequency to the highest line above which the lines do not determine the mode.
const FAR: f64 = 10.0;
/// 95 % of a normal distribution, in standard deviations.
const NORMAL: f64 = 1.96;

/// The data of a fit.
pub(super) struct Measured {
    pub(super) name: String,
    pub(super) points: Vec<Point>,
    /// Whether the recordings are whole.
    pub(super) outcome: Outcome,
    /// Coherence of each point; 1 if a file has none.
    coherence: Vec<f64>,
    /// The model's own response at each point.
    model: Vec<Complex<f64>>,
    /// The model's own final value.
    expected_final: Option<f64>,
}

impl Measured {
    fn new(name: String, model: &Model, lines: &[Line], outcome: Outcome) -> Self {
        let lines = response::apart(lines);
        let coherence = lines.iter().map(|line| line.coherence).collect();
        let points: Vec<Point> = lines.iter().map(Point::from).collect();
        let at = |hz: f64| of_model(model, &name, hz);
        let own = points.iter().map(|point| at(point.frequency_hz).unwrap_or_default()).collect();
        let expected_final = at(0.0).map(|value| value.re).filter(|value| value.is_finite());
        Self { points, outcome, coherence, model: own, expected_final, name }
    }

    fn highest_hz(&self) -> f64 {
        self.points.iter().map(|point| point.frequency_hz).fold(0.0, f64::max)
    }

    /// `tried`: the fit and the other fits, by rank.
    fn beside_model(&self, fit: &Fit, tried: &[Fit]) -> Beside {
        let mut beside = Beside::default();
        for ((point, coherence), exact) in self.points.iter().zip(&self.coherence).zip(&self.model) {
            let ratio = fit.transfer.response(point.frequency_hz) / exact;
            let std = rational::response_std_among(tried, point.frequency_hz);
            let [magnitude, phase] = std.map(|std| NORMAL * std);
            beside.add(ratio, *coherence, [ratio.norm().ln().abs() <= magnitude, ratio.arg().abs() <= phase]);
        }
        beside
    }
}

pub(super) fn run(args: &Args, model: &Model) -> anyhow::Result<Outcome> {
    let measured = measured(args, model)?;
    let stable = args.task.stable;
    let mut fits = match args.task.orders {
        Some(_) => Vec::new(),
        None => rational::advise(&measured.points, HIGHEST, stable),
    };
    if fits.is_empty() {
        // The error of the lowest order says why none fits.
        let orders = args.task.orders.unwrap_or(Orders { numerator: 0, denominator: 1 });
        fits.push(rational::fit(&measured.points, orders, stable)?);
    }
    let fit = fits.first().context("no transfer function of order 1 to 6 fits these data")?;
    let document = json(args, model, &measured, fit, &fits);
    if let Some(dir) = &args.report {
        output::write_folder(dir, &files(args, model, &measured, fit, &fits, &document)?)?;
    }
    if args.json {
        output::print_json(&document)?;
    } else {
        output::print(&text(model, &measured, fit, &fits))?;
    }
    Ok(measured.outcome)
}

/// Lines to fit to, of recordings or of a response that `--method frf` wrote.
pub(super) fn measured(args: &Args, model: &Model) -> anyhow::Result<Measured> {
    let output = match &args.task.signals.outputs[..] {
        [] => {
            let speed = model.outputs().find(|channel| channel.quantity == Quantity::Speed);
            speed.or_else(|| model.outputs().next()).map(|channel| channel.name.clone())
        }
        [one] => Some(one.clone()),
        _ => return Err(WrongArguments("a transfer function is of one --output".into()).into()),
    };
    let output = output.context("the model has no output")?;
    if let [only] = &args.runs[..]
        && let Some(lines) = response_file(Path::new(only), &output)?
    {
        return Ok(Measured::new(output, model, &lines, Outcome::Done));
    }
    let datasets = output::open_all(Grid::View, &args.runs)?;
    let answers = frf::estimate(args, model, &datasets, std::slice::from_ref(&output))?;
    let lines: Vec<Line> = answers.into_iter().flat_map(|answer| answer.response.lines).collect();
    Ok(Measured::new(output, model, &lines, Outcome::on(&datasets)))
}

fn of_model(model: &Model, output: &str, frequency_hz: f64) -> Option<Complex<f64>> {
    let equations = model.equations(&model.values()).ok()?;
    let index = model.outputs().position(|channel| channel.name == output)?;
    let input = model.inputs().position(|channel| !channel.quantity.is_clock())?;
    equations.transfer(index, input, Complex::new(0.0, std::f64::consts::TAU * frequency_hz))
}

/// A note on a mode from lines up to `highest_hz`.
fn note(mode: &rational::ModeEstimate, highest_hz: f64) -> &'static str {
    match mode.mode {
        m if m.natural_frequency_hz > FAR * highest_hz => "far beyond the lines: not determined",
        m if m.pole.re >= 0.0 => "not stable",
        m if m.pole.im == 0.0 => "a real pole, no resonance",
        m if m.damping_ratio > 0.5_f64.sqrt() => "damped beyond a resonance peak",
        _ => "",
    }
}

fn final_value_text(measured: &Measured, fit: &Fit) -> String {
    let value = fit.transfer.final_value();
    let half = NORMAL * fit.final_value_std;
    let mut text = format!("final value {} +- {}", table::number(value), table::number(half));
    if let Some(expected) = measured.expected_final {
        let holds = (value - expected).abs() <= half;
        let judged = if holds { "holds it" } else { "does not hold it" };
        let _ = write!(text, "; the model's is {}: the 95 % interval {judged}", table::number(expected));
    }
    text
}

fn json(args: &Args, model: &Model, measured: &Measured, fit: &Fit, tried: &[Fit]) -> Value {
    let roots =
        |roots: Vec<Complex<f64>>| roots.iter().map(|root| json!([root.re, root.im])).collect::<Vec<_>>();
    let half = NORMAL * fit.final_value_std;
    let value = fit.transfer.final_value();
    json!({
        "schema": SCHEMA, "method": "etf", "model": model.name, "recordings": args.runs, "output": measured.name,
        "orders": [fit.orders.numerator, fit.orders.denominator], "stable": fit.transfer.poles().iter().all(|p| p.re < 0.0),
        "converged": fit.converged, "misfit": fit.misfit, "lines": measured.points.len(),
        "numerator": fit.transfer.numerator, "numerator_std": fit.numerator_std,
        "denominator": fit.transfer.denominator, "denominator_std": fit.denominator_std,
        "poles": roots(fit.transfer.poles()), "zeros": roots(fit.transfer.zeros()),
        "beside_model": measured.beside_model(fit, tried).json(),
        "final_value": {"value": value, "ci95": [value - half, value + half], "model": measured.expected_final},
        "modes": fit.modes.iter().map(|m| json!({
            "natural_frequency_hz": m.mode.natural_frequency_hz, "natural_frequency_std_hz": m.frequency_std_hz,
            "damping_ratio": m.mode.damping_ratio, "damping_ratio_std": m.damping_std, "note": note(m, measured.highest_hz()),
        })).collect::<Vec<_>>(),
        "orders_tried": tried.iter().filter(|_| tried.len() > 1).map(|t| json!({
            "orders": [t.orders.numerator, t.orders.denominator], "misfit": t.misfit, "description_length": t.description_length,
        })).collect::<Vec<_>>(),
    })
}

fn text(model: &Model, measured: &Measured, fit: &Fit, tried: &[Fit]) -> String {
    let mut text = format!(
        "{} by etf: {} of order {}, {} lines, misfit {:.2} (1 where orders suffice){}\n",
        model.name,
        measured.name,
        fit.orders,
        measured.points.len(),
        fit.misfit,
        if fit.converged { "" } else { ", not converged" }
    );
    if tried.len() > 1 {
        text.push_str("\nOrders advised (least description length first)\n");
        let mut rows = vec![["order", "misfit", "length over the best"].map(str::to_owned).to_vec()];
        rows.extend(tried.iter().take(SHOWN).map(|t| {
            vec![
                t.orders.to_string(),
                format!("{:.3}", t.misfit),
                format!("{:.1}", t.description_length - tried[0].description_length),
            ]
        }));
        text.push_str(&table::align(&rows, &[false, true, true]));
    }
    for table in tables(fit, measured.highest_hz()) {
        text.push('\n');
        text.push_str(&table::align(&table, &[false, true, true, true, true, false]));
    }
    let _ = writeln!(text, "\n  {}", final_value_text(measured, fit));
    let _ = writeln!(text, "  {}", measured.beside_model(fit, tried).sentence());
    text
}

/// Coefficients and modes; the first row of each table is the header.
fn tables(fit: &Fit, highest_hz: f64) -> Vec<Vec<Vec<String>>> {
    let head = ["power of s", "numerator", "std", "denominator", "std"].map(str::to_owned).to_vec();
    let Orders { numerator, denominator } = fit.orders;
    let cell = |values: &[f64], power: usize, most: usize| {
        // The leading coefficient of the denominator is 1 and has no standard deviation.
        let shown = values.get(power).filter(|value| power <= most && **value != 0.0);
        shown.map_or_else(String::new, |value| if *value == 1.0 { "1".into() } else { table::number(*value) })
    };
    let row = |power: usize| {
        vec![
            power.to_string(),
            cell(&fit.transfer.numerator, power, numerator),
            cell(&fit.numerator_std, power, numerator),
            cell(&fit.transfer.denominator, power, denominator),
            cell(&fit.denominator_std, power, denominator),
        ]
    };
    let coefficients = std::iter::once(head).chain((0..=denominator).rev().map(row)).collect();
    let head = ["mode", "Hz", "std", "damping ratio", "std", ""].map(str::to_owned).to_vec();
    let mode = |(index, mode): (usize, &rational::ModeEstimate)| {
        vec![
            (index + 1).to_string(),
            table::number(mode.mode.natural_frequency_hz),
            table::number(mode.frequency_std_hz),
            table::number(mode.mode.damping_ratio),
            table::number(mode.damping_std),
            note(mode, highest_hz).to_owned(),
        ]
    };
    vec![coefficients, std::iter::once(head).chain(fit.modes.iter().enumerate().map(mode)).collect()]
}

fn files(
    args: &Args,
    model: &Model,
    measured: &Measured,
    fit: &Fit,
    tried: &[Fit],
    document: &Value,
) -> anyhow::Result<Vec<(String, String)>> {
    let drawn = report::transfer(&measured.name, tried, &measured.points);
    let mut files =
        vec![("transfer.json".to_owned(), format!("{}\n", serde_json::to_string_pretty(document)?))];
    files.extend(drawn.iter().map(|p| (format!("{}-{}.svg", measured.name, p.name), p.svg())));
    let sentences = vec![
        format!(
            "Order {}, {} lines, misfit {:.2} (1 where orders suffice).",
            fit.orders,
            measured.points.len(),
            fit.misfit
        ),
        format!("Its {}.", final_value_text(measured, fit)),
    ];
    let section = Section {
        title: measured.name.clone(),
        sentences,
        pictures: drawn,
        tables: tables(fit, measured.highest_hz()),
    };
    let title = format!("Transfer function of {}", model.name);
    files.push((
        "index.html".to_owned(),
        report::page(&title, &format!("From {}.", args.runs.join(", ")), &[section]),
    ));
    Ok(files)
}
