//! Results as tables for people.

use socam_identify::{BetweenSource, ChannelFit, End, Fit, Identification, ParameterEstimate, Source};

/// Offsets that are listed one by one.
const MOST_OFFSETS: usize = 12;

/// Columns aligned: text left, numbers right.
pub(crate) fn align(rows: &[Vec<String>], right: &[bool]) -> String {
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..right.len()).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::from(" ");
        for ((cell, width), right) in row.iter().zip(&widths).zip(right) {
            line.push(' ');
            line.push_str(&if *right { format!("{cell:>width$} ") } else { format!("{cell:<width$} ") });
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

pub(crate) use socam_job::notation::number;

/// A number to four significant digits, without trailing zeros.
pub(crate) fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => format!("{rounded}"),
        _ => format!("{rounded:e}"),
    }
}

pub(crate) fn interval(ends: [Option<f64>; 2]) -> String {
    match ends {
        [None, None] => String::new(),
        [low, high] => {
            let end = |value: Option<f64>| value.map_or_else(|| "...".into(), number);
            format!("[{}, {}]", end(low), end(high))
        }
    }
}

pub(crate) fn end(end: End) -> &'static str {
    match end {
        End::Converged => "converged",
        End::AtBound => "converged, with a parameter at its bound",
        End::Stalled => "stalled",
        End::IterationLimit => "stopped at the iteration limit",
        End::Interrupted => "interrupted at the best point so far",
        End::Budget => "ended by its budget at the best point so far",
    }
}

fn estimate_row(parameter: &ParameterEstimate) -> Vec<String> {
    let is_fixed = parameter.source == Source::Fixed && parameter.note.is_empty();
    let note = if is_fixed { "fixed".into() } else { parameter.note.clone() };
    let note = if parameter.source == Source::Prior { format!("mostly from its prior {note}") } else { note };
    vec![
        parameter.name.clone(),
        parameter.value.map_or_else(|| "-".into(), number),
        parameter.unit.clone(),
        interval(parameter.ci95),
        note,
    ]
}

pub(crate) fn parameters(result: &Identification) -> String {
    let head = ["parameter", "estimate", "unit", "95 % interval", ""].map(String::from).to_vec();
    let rows: Vec<_> = std::iter::once(head).chain(result.parameters.iter().map(estimate_row)).collect();
    align(&rows, &[false, true, false, false, false])
}

pub(crate) fn combinations(result: &Identification) -> String {
    if result.combinations.is_empty() {
        return String::new();
    }
    let head = ["combination", "estimate", "unit", "95 % interval", "is"].map(String::from).to_vec();
    let rows = result.combinations.iter().map(|combination| {
        vec![
            combination.name.clone(),
            combination.value.map_or_else(|| "-".into(), number),
            combination.unit.clone(),
            if combination.value.is_some() { interval(combination.ci95) } else { "not determined".into() },
            combination.expression.clone(),
        ]
    });
    let rows: Vec<_> = std::iter::once(head).chain(rows).collect();
    format!("\n{}", align(&rows, &[false, true, false, false, false]))
}

/// Advice for quantities that are not determined, as text.
pub(crate) fn advice(result: &Identification) -> String {
    if result.advice.is_empty() {
        return String::new();
    }
    format!(
        "\nWhat would settle the rest\n{}",
        result.advice.iter().map(|line| wrapped(line)).collect::<String>()
    )
}

/// A sentence in lines of at most 110 characters, indented.
fn wrapped(sentence: &str) -> String {
    let mut lines = vec![String::from(" ")];
    for word in sentence.split(' ') {
        let last = lines.len() - 1;
        if lines[last].len() + word.len() > 110 {
            lines.push(format!("    {word}"));
        } else {
            lines[last].push(' ');
            lines[last].push_str(word);
        }
    }
    lines.iter().map(|line| format!("{line}\n")).collect()
}

pub(crate) fn nuisance(result: &Identification) -> String {
    if result.nuisance.is_empty() {
        return String::new();
    }
    if result.nuisance.len() > MOST_OFFSETS {
        return format!("\n{}", align(&summary(&result.nuisance), &[false, true, true, true, false]));
    }
    let head = ["sensor offset", "estimate", "unit", "95 % interval", ""].map(String::from).to_vec();
    let rows: Vec<_> = std::iter::once(head).chain(result.nuisance.iter().map(estimate_row)).collect();
    format!("\n{}", align(&rows, &[false, true, false, false, false]))
}

/// Offsets of many segments, one line for each channel; `--json` has them all.
fn summary(offsets: &[ParameterEstimate]) -> Vec<Vec<String>> {
    let channel = |offset: &ParameterEstimate| {
        offset.name.split_once(" in ").map_or(offset.name.clone(), |(channel, _)| channel.into())
    };
    let mut channels: Vec<String> = offsets.iter().map(channel).collect();
    channels.sort();
    channels.dedup();
    let head = ["sensor offset", "lowest", "median", "highest", "unit"].map(String::from).to_vec();
    let line = |name: &String| {
        let own = || offsets.iter().filter(|offset| channel(offset) == *name);
        let mut values: Vec<f64> = own().filter_map(|offset| offset.value).collect();
        values.sort_by(f64::total_cmp);
        let at = |index: usize| values.get(index).map_or_else(|| "-".into(), |value| number(*value));
        let unit = own().next().map_or("", |offset| &offset.unit);
        let name = format!("{name}, {} stretches", own().count());
        vec![name, at(0), at(values.len() / 2), at(values.len().wrapping_sub(1)), unit.into()]
    };
    std::iter::once(head).chain(channels.iter().map(line)).collect()
}

/// Noise levels on which weights and intervals rest, in one line.
pub(crate) fn noise(result: &Identification) -> String {
    if result.input_noise_std.is_empty() {
        return String::new();
    }
    let list = |levels: Vec<(&String, f64)>| {
        let each = levels.into_iter().map(|(name, std)| format!("{name} {}", number(std)));
        each.collect::<Vec<_>>().join(", ")
    };
    // What the model leaves beyond its sensors' noise is its misfit, and stands in the table above.
    let sensor = |fit: &ChannelFit| fit.sensor_noise_std.map_or(fit.noise_std, |std| std.min(fit.noise_std));
    let read = result.fit.channels.iter().filter(|(_, fit)| fit.rms.is_finite());
    let outputs = read.map(|(name, fit)| (name, sensor(fit))).collect();
    let noisy = result.input_noise_std.iter().filter(|(_, std)| *std > 0.0);
    let inputs: Vec<_> = noisy.map(|(name, std)| (name, *std)).collect();
    let inputs = if inputs.is_empty() { "none".into() } else { list(inputs) };
    format!("  noise, SI: of outputs {}; of inputs {inputs}\n", list(outputs))
}

/// How the inputs behave between their samples, in one line, and how that is known.
pub(crate) fn between(result: &Identification) -> String {
    let each = result.between.iter().map(|(input, own)| {
        let kind = own.kind.name();
        match (own.source, own.rival.zip(own.rival_deviance)) {
            (BetweenSource::Stated, _) => format!("{input} {kind} (stated)"),
            (_, Some((rival, worse))) if worse < 0.0 => {
                format!("{input} {kind} ({} fits hardly better)", rival.name())
            }
            (BetweenSource::Data, Some((rival, worse))) => {
                format!("{input} {kind} ({} fits worse, chi-square +{worse:.0})", rival.name())
            }
            (_, Some((rival, _))) => format!("{input} {kind} (usual; {} fits as well)", rival.name()),
            (_, None) => format!("{input} {kind} (usual)"),
        }
    });
    let each: Vec<_> = each.collect();
    if each.is_empty() { String::new() } else { format!("  between samples: {}\n", each.join(", ")) }
}

pub(crate) fn fit(title: &str, fit: &Fit) -> String {
    let head = ["channel", "residual rms", "of its std", "of its norm"].map(String::from).to_vec();
    let row = |(name, fit): &(String, ChannelFit)| {
        let percent = |value: f64| format!("{value:.4} %");
        if !fit.rms.is_finite() {
            return vec![name.clone(), "not fitted".into(), String::new(), String::new()];
        }
        vec![name.clone(), number(fit.rms), percent(fit.nrmse_percent), percent(fit.relative_error_percent)]
    };
    let rows: Vec<_> = std::iter::once(head).chain(fit.channels.iter().map(row)).collect();
    format!("\n{title}\n{}", align(&rows, &[false, true, true, true]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_offsets_take_a_line_for_each_channel() {
        let offset = |channel: &str, k: u32| ParameterEstimate {
            name: format!("offset of {channel} in run.mcap from {k}.000 s"),
            value: (k > 0).then(|| f64::from(k)),
            unit: "N m".into(),
            std: None,
            ci95: [None, None],
            identifiable: true,
            source: Source::Data,
            determined_with: Vec::new(),
            note: String::new(),
        };
        let all: Vec<_> = (0..100).flat_map(|k| [offset("torque_in", k), offset("torque_out", k)]).collect();
        let rows = summary(&all);
        assert_eq!(rows.len(), 3);
        assert_eq!(rows[1], ["offset of torque_in, 100 stretches", "1.0000", "50.000", "99.000", "N m"]);
    }
}
