//! `identify --method frf`: the frequency response with coherence, confidence and distortion.

use std::fmt::Write as _;

use serde_json::Value;
use socam_frequency::response::{Method, Response};
use socam_job::Grid;
use socam_model::Model;
use socam_recording::Dataset;
use socam_report::response::{self, Section};
use socam_response::{Answer, answer::decibel, document};

use super::Args;
use crate::{commands::Outcome, output, table};

/// Number of lines in the table.
const SHOWN: usize = 16;

pub(super) fn run(args: &Args, model: &Model) -> anyhow::Result<Outcome> {
    let datasets = output::open_all(Grid::View, &args.runs)?;
    let answers = estimate(args, model, &datasets, &args.task.signals.outputs)?;
    let document = document(&model.name, &args.runs, &answers);
    if let Some(dir) = &args.report {
        output::write_folder(dir, &files(args, model, &answers, &document)?)?;
    }
    if args.json {
        output::print_json(&document)?;
    } else {
        output::print(&text(model, &answers))?;
    }
    Ok(Outcome::on(&datasets))
}

/// Responses of the chosen outputs. Prints how the signals were processed.
pub(super) fn estimate<'m>(
    args: &Args,
    model: &'m Model,
    datasets: &[Dataset],
    wanted: &[String],
) -> anyhow::Result<Vec<Answer<'m>>> {
    let answers = args.task.signals.estimate(model, datasets, wanted, args.task.band)?;
    for answer in &answers {
        answer.warnings.iter().for_each(output::warn);
        answer.notes.iter().for_each(output::say);
    }
    Ok(answers)
}

fn method(response: &Response) -> String {
    match response.method {
        Method::Periodic { period_s, periods } => {
            format!("{periods} periods of {} s, noise from between the lines", table::number(period_s))
        }
        Method::Local => "local polynomials, transients estimated beside the response".into(),
    }
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
        for sentence in answer.distortion_sentences() {
            let _ = writeln!(text, "  {sentence}");
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
        let drawn = response::pictures(answer);
        let mut sentences = vec![format!("Estimated from {}.", method(&answer.response))];
        sentences.extend(answer.distortion_sentences().iter().map(|sentence| format!("{sentence}.")));
        for picture in &drawn {
            files.push((format!("{}-{}.svg", answer.pair.output.name, picture.name), picture.svg()));
        }
        let title = format!("{} per {}", answer.pair.output.name, answer.pair.input.name);
        sections.push(Section { title, sentences, pictures: drawn, tables: Vec::new() });
    }
    let title = format!("Frequency response of {}", model.name);
    let about = format!("From {}.", args.runs.join(", "));
    files.push(("index.html".to_owned(), response::page(&title, &about, &sections)));
    Ok(files)
}
