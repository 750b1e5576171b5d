//! `identify --method frf`: the frequency response with coherence, confidence and distortion.

use std::fmt::Write as _;

use serde_json::{Value, json};
use socam_frequency::{
    Complex,
    response::{self, Distortion, Line, Method, Options, Parity, Response},
};
use socam_model::{Equations, Model};
use socam_recording::Dataset;

use super::{
    answer::{Answer, decibel},
    args::Args,
    page::{self, Picture, Section},
    pictures,
    signals::{self, Pair},
};
use crate::{commands::Outcome, output, table};

const SCHEMA: &str = "socam.frequency-response/1";
/// Number of lines in the table.
const SHOWN: usize = 16;
/// Default band, Hz; it ends at a third of the sampling rate if that is lower.
const BAND_HZ: [f64; 2] = [0.1, 100.0];

pub(super) fn run(args: &Args, model: &Model) -> anyhow::Result<Outcome> {
    let each = args.runs.iter().map(|run| output::open_regular(run));
    let datasets = each.collect::<anyhow::Result<Vec<_>>>()?;
    let answers = estimate(args, model, &datasets, &args.frequency.output)?;
    let document = json(args, model, &answers);
    if let Some(dir) = &args.frequency.report {
        page::write_all(dir, &files(args, model, &answers, &document)?)?;
    }
    if args.json {
        output::print_json(&document)?;
    } else {
        output::print(&text(model, &answers))?;
    }
    Ok(Outcome::on(&datasets))
}

/// Responses of the chosen outputs.
pub(super) fn estimate<'m>(
    args: &Args,
    model: &'m Model,
    datasets: &[Dataset],
    wanted: &[String],
) -> anyhow::Result<Vec<Answer<'m>>> {
    let equations = model.equations(&model.values())?;
    let pairs = signals::pairs(model, wanted)?;
    pairs
        .into_iter()
        .map(|pair| {
            let segments = signals::segments(datasets, &pair, args.frequency.reference.as_deref())?;
            signals::say_bias(&segments, &pair);
            let segments = args.frequency.prepared(segments)?;
            let rate_hz = segments.iter().map(|s| 1.0 / s.sample_time_s).fold(f64::INFINITY, f64::min);
            let band_hz =
                args.band.map_or([BAND_HZ[0], BAND_HZ[1].min(rate_hz / 3.0)], |b| [b.low_hz(), b.high_hz()]);
            let options = Options { band_hz, period_s: args.frequency.period };
            let signals: Vec<_> = segments.iter().map(signals::Segment::signals).collect();
            let response = response::estimate(&signals, &options)?;
            let model = response.lines.iter().map(|line| of_model(&equations, &pair, line)).collect();
            Ok(Answer { pair, response, model })
        })
        .collect()
}

fn of_model(equations: &Equations, pair: &Pair<'_>, line: &Line) -> Complex<f64> {
    let s = Complex::new(0.0, std::f64::consts::TAU * line.frequency_hz);
    equations.transfer(pair.output_index, pair.input_index, s).unwrap_or_default()
}

fn method(response: &Response) -> String {
    match response.method {
        Method::Periodic { period_s, periods } => {
            format!("{periods} periods of {} s, noise from between the lines", table::number(period_s))
        }
        Method::Local => "local polynomials, transients estimated beside the response".into(),
    }
}

fn json(args: &Args, model: &Model, answers: &[Answer<'_>]) -> Value {
    let finite = |value: f64| value.is_finite().then_some(value);
    let line = |(line, exact): (&Line, &Complex<f64>)| {
        let phase = line.response.arg().to_degrees();
        json!({
            "frequency_hz": line.frequency_hz, "re": line.response.re, "im": line.response.im,
            "magnitude": line.response.norm(), "magnitude_ci95": line.magnitude_ci95(),
            "phase_deg": phase, "phase_ci95_deg": [phase - line.phase_half_width_deg(), phase + line.phase_half_width_deg()],
            "std": finite(line.variance.sqrt()), "radius95": finite(line.radius()), "coherence": line.coherence,
            "freedom": line.freedom, "width_hz": line.width_hz,
            "model_re": exact.re, "model_im": exact.im,
        })
    };
    let outputs = answers.iter().map(|answer| {
        json!({
            "output": answer.pair.output.name, "unit": answer.pair.output.unit,
            "input": answer.pair.input.name, "input_unit": answer.pair.input.unit,
            "estimated_by": match answer.response.method {
                Method::Periodic { period_s, periods } => json!({"method": "periodic", "period_s": period_s, "periods": periods}),
                Method::Local => json!({"method": "local_polynomial"}),
            },
            "beside_model": answer.beside_model().json(),
            "distortion": answer.response.distortion.as_ref().map(|d| json!({
                "even": d.even.map(parity_json), "odd": d.odd.map(parity_json),
            })),
            "lines": answer.response.lines.iter().zip(&answer.model).map(line).collect::<Vec<_>>(),
        })
    });
    json!({
        "schema": SCHEMA, "method": "frf", "model": model.name, "recordings": args.runs,
        "outputs": outputs.collect::<Vec<_>>(),
    })
}

fn parity_json(parity: Parity) -> Value {
    json!({
        "lines": parity.lines, "level_db": parity.level_db, "noise_db": parity.noise_db,
        "over_noise": parity.over_noise, "p_value": parity.p_value, "significant": parity.significant,
    })
}

/// Interpretation of the lines that are not excited, one sentence per parity.
pub(super) fn distortion_sentences(distortion: &Distortion) -> Vec<String> {
    let sentence = |name: &str, means: &str, parity: Option<Parity>| {
        let parity = parity?;
        Some(match parity.level_db {
            Some(level) if parity.significant => format!(
                "{name} lines that nothing drives stand at {level:.1} dB, noise at {:.1} dB (p {:.1e}): {means}; `diagnose` finds out what",
                parity.noise_db, parity.p_value
            ),
            _ => format!(
                "{name} lines that nothing drives ({}) hold noise only, at {:.1} dB of the driven ones",
                parity.lines, parity.noise_db
            ),
        })
    };
    let even = sentence("Even", "something acts differently in the two directions", distortion.even);
    let odd = sentence(
        "Odd",
        "something bends the same way in both directions, as friction or hardening does",
        distortion.odd,
    );
    even.into_iter().chain(odd).collect()
}

fn text(model: &Model, answers: &[Answer<'_>]) -> String {
    let mut text = format!("{} by frf\n", model.name);
    for answer in answers {
        let (lines, pair) = (&answer.response.lines, &answer.pair);
        let _ = write!(
            text,
            "\n{} per {}: {} lines, {}\n",
            pair.output.name,
            pair.input.name,
            lines.len(),
            method(&answer.response)
        );
        let head = ["Hz", "dB", "+-", "degrees", "+-", "coherence", "model dB", "model degrees"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        let step = lines.len().div_ceil(SHOWN).max(1);
        rows.extend(lines.iter().zip(&answer.model).step_by(step).map(|(line, exact)| {
            let [low, high] = line.magnitude_ci95();
            let half_db = if low > 0.0 { 0.5 * (decibel(high) - decibel(low)) } else { f64::INFINITY };
            vec![
                table::number(line.frequency_hz),
                format!("{:.2}", decibel(line.response.norm())),
                format!("{half_db:.2}"),
                format!("{:.1}", line.response.arg().to_degrees()),
                format!("{:.1}", line.phase_half_width_deg()),
                format!("{:.3}", line.coherence),
                format!("{:.2}", decibel(exact.norm())),
                format!("{:.1}", exact.arg().to_degrees()),
            ]
        }));
        text.push_str(&table::align(&rows, &[true; 8]));
        let _ = writeln!(text, "  {}", answer.beside_model().sentence());
        if let Some(distortion) = &answer.response.distortion {
            for sentence in distortion_sentences(distortion) {
                let _ = writeln!(text, "  {sentence}");
            }
        }
    }
    text
}

fn csv(answers: &[Answer<'_>]) -> String {
    let mut text = String::from(
        "output,frequency_hz,re,im,magnitude_db,magnitude_low_db,magnitude_high_db,phase_deg,phase_half_width_deg,std,freedom,width_hz,coherence,model_re,model_im\n",
    );
    for answer in answers {
        for (line, exact) in answer.response.lines.iter().zip(&answer.model) {
            let [low, high] = line.magnitude_ci95().map(decibel);
            let low = if low.is_finite() { low.to_string() } else { String::new() };
            let _ = writeln!(
                text,
                "{},{},{},{},{},{low},{high},{},{},{},{},{},{},{},{}",
                answer.pair.output.name,
                line.frequency_hz,
                line.response.re,
                line.response.im,
                decibel(line.response.norm()),
                line.response.arg().to_degrees(),
                line.phase_half_width_deg(),
                line.variance.sqrt(),
                line.freedom,
                line.width_hz,
                line.coherence,
                exact.re,
                exact.im
            );
        }
    }
    text
}

fn files(
    args: &Args,
    model: &Model,
    answers: &[Answer<'_>],
    document: &Value,
) -> anyhow::Result<Vec<(String, String)>> {
    let mut files = vec![
        ("response.json".to_owned(), format!("{}\n", serde_json::to_string_pretty(document)?)),
        ("response.csv".to_owned(), csv(answers)),
    ];
    let mut sections = Vec::new();
    for answer in answers {
        let drawn = pictures::response(answer);
        let mut sentences = vec![format!("Estimated from {}.", method(&answer.response))];
        sentences.extend(
            answer.response.distortion.iter().flat_map(distortion_sentences).map(|s| format!("{s}.")),
        );
        for Picture { name, plot } in &drawn {
            files.push((
                format!("{}-{name}.svg", answer.pair.output.name),
                socam_plot::standalone(&plot.plot()),
            ));
        }
        let title = format!("{} per {}", answer.pair.output.name, answer.pair.input.name);
        sections.push(Section { title, sentences, pictures: drawn, tables: Vec::new() });
    }
    let title = format!("Frequency response of {}", model.name);
    let about = format!("From {}.", args.runs.join(", "));
    files.push(("index.html".to_owned(), page::page(&title, &about, &sections)));
    Ok(files)
}
