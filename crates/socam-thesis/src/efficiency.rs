//! Chapter 5: efficiencies; points 10, 11 and 17.

use crate::{
    Printed, Thesis,
    report::{Report, Row, Verdict, row, short},
};

/// One row of the tables of chapter 5.
struct Steady<'a> {
    printed: &'a [Printed; 6],
}

impl Steady<'_> {
    fn rpm(&self) -> &str {
        &self.printed[0].text
    }

    /// Input speed, output speed, input torque, output torque.
    fn values(&self) -> [f64; 4] {
        [1, 2, 3, 4].map(|i| self.printed[i].value)
    }

    /// Power out over power in, percent.
    fn efficiency(&self) -> f64 {
        let [input, output, torque_in, torque_out] = self.values();
        100.0 * output * torque_out / (input * torque_in)
    }

    fn row(&self) -> Row {
        let share = self.printed[1..5].iter().map(Printed::rounding).sum();
        let calculation = format!(
            "{} x {} / ({} x {})",
            self.printed[2].text, self.printed[4].text, self.printed[1].text, self.printed[3].text
        );
        row(
            format!("efficiency at {} rpm", self.rpm()),
            "%",
            &self.printed[5],
            self.efficiency(),
            share,
            calculation,
        )
    }
}

fn steady(rows: &[[Printed; 6]; 3]) -> [Steady<'_>; 3] {
    rows.each_ref().map(|printed| Steady { printed })
}

pub(crate) fn examine(thesis: &Thesis, report: &mut Report) {
    let data = &thesis.efficiency;
    let (system, first, second) = (steady(&data.system), steady(&data.coupling_1), steady(&data.coupling_2));
    report.table("Table 5.1", "System efficiency", system.iter().map(Steady::row).collect());
    report.table("Table 5.2", "Efficiency of coupling 1", first.iter().map(Steady::row).collect());
    report.table("Table 5.3", "Efficiency of coupling 2", second.iter().map(Steady::row).collect());
    let reducer = |i: usize| {
        let [whole, one, two] = [&system[i], &first[i], &second[i]].map(|row| row.printed[5].value);
        1e4 * whole / (one * two)
    };
    let rows = (0..3).map(|i| {
        let calculation = format!(
            "{} / ({} x {}) %",
            system[i].printed[5].text, first[i].printed[5].text, second[i].printed[5].text
        );
        row(
            format!("reducer at {} rpm", system[i].rpm()),
            "%",
            &data.reducer_percent[i],
            reducer(i),
            0.0,
            calculation,
        )
    });
    report.table("Table 5.4", "Efficiency of the reducer (eq. 5.5)", rows.collect());
    tachometers(thesis, report, &system, &[&first, &second]);
    losses(thesis, report, &system);
    report.point(
        17,
        Verdict::Refuted,
        "Two rows of 1500 rpm do not follow from their own inputs",
        vec![
            format!(
                "Table 5.2: {} x {} / ({} x {}) = {:.3} %, printed {} %; Table 5.3 has the same speeds, the same efficiency, and the torques the other way round: {:.3} %",
                first[2].printed[2].text, first[2].printed[4].text, first[2].printed[1].text, first[2].printed[3].text,
                first[2].efficiency(), first[2].printed[5].text, second[2].efficiency()
            ),
            format!("Table 5.4: {:.3} % from its inputs, printed {} %", reducer(2), data.reducer_percent[2].text),
        ],
        "One of the two couplings' rows was copied from the other's.",
    );
}

/// Losses of the couplings: a line for each row, and the fractions of speed and of torque that are lost.
fn coupling_losses(couplings: &[&[Steady<'_>; 3]; 2]) -> (Vec<String>, Vec<f64>, Vec<f64>) {
    let mut lines = Vec::new();
    let mut speed_losses = Vec::new();
    let mut torque_losses = Vec::new();
    for (index, coupling) in couplings.iter().enumerate() {
        for row in *coupling {
            let [input, output, torque_in, torque_out] = row.values();
            speed_losses.push(1.0 - output / input);
            torque_losses.push(1.0 - torque_out / torque_in);
            lines.push(format!(
                "coupling {} at {} rpm: torques {:.4}, speeds {:.4}: of the {:.2} % lost, {:.2} % are speed",
                index + 1,
                row.rpm(),
                torque_out / torque_in,
                output / input,
                100.0 - row.efficiency(),
                100.0 * (1.0 - output / input)
            ));
        }
    }
    (lines, speed_losses, torque_losses)
}

/// Point 10: the gain error of a tachometer.
fn tachometers(
    thesis: &Thesis,
    report: &mut Report,
    system: &[Steady<'_>; 3],
    couplings: &[&[Steady<'_>; 3]; 2],
) {
    let ratio = thesis.hardware.ratio.value;
    let (mut lines, speed_losses, torque_losses) = coupling_losses(couplings);
    for row in system {
        let [input, output, ..] = row.values();
        lines.push(format!(
            "reducer at {} rpm: speeds {:.4} instead of {ratio}: {:+.2} %",
            row.rpm(),
            input / output,
            100.0 * (input / output / ratio - 1.0)
        ));
    }
    let constrained = system.iter().map(|row| 100.0 * row.values()[3] / (ratio * row.values()[2]));
    let constrained: Vec<f64> = constrained.collect();
    for (row, eta) in system.iter().zip(&constrained) {
        lines.push(format!(
            "tau_2/(N tau_1) at {} rpm = {} / ({ratio} x {}) = {eta:.2} %",
            row.rpm(),
            row.printed[4].text,
            row.printed[3].text
        ));
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let speed_ratios: Vec<f64> =
        system.iter().map(|row| 100.0 * (row.values()[0] / row.values()[1] / ratio - 1.0)).collect();
    let conclusion = format!(
        "Concealed: a tachometer's gain. Ends of a coupling turn equally fast in the mean, so {:.2} % of speed lost is {:.2} % of wrong \
         gain between two tachometers, and the torques, which do tell a loss, show {:.2} % on average: none. The reducer's speeds miss \
         its ratio by {}: no one gain explains all three. With the speeds' ratio that the drive forces, the reducer's efficiency is {}, \
         not the printed {}, which divide by losses of couplings that are not there.",
        100.0 * mean(&speed_losses),
        100.0 * mean(&speed_losses),
        100.0 * mean(&torque_losses),
        list(&speed_ratios, 2),
        list(&constrained, 2),
        thesis.efficiency.reducer_percent.each_ref().map(|p| format!("{} %", p.text)).join(", ")
    );
    report.point(
        10,
        Verdict::Concealed,
        "The couplings lose nothing measurable; a tachometer reads wrong",
        lines,
        conclusion,
    );
}

fn list(values: &[f64], digits: usize) -> String {
    values.iter().map(|value| format!("{value:.digits$} %")).collect::<Vec<_>>().join(", ")
}

/// Point 11: the loss proportional to torque, and the load.
fn losses(thesis: &Thesis, report: &mut Report, system: &[Steady<'_>; 3]) {
    let ratio = thesis.hardware.ratio.value;
    let values: Vec<[f64; 4]> = system.iter().map(Steady::values).collect();
    // The motor's tachometer sets the speed; the output turns N times slower.
    let speeds: Vec<f64> = values.iter().map(|v| v[0] / ratio).collect();
    let supplied: Vec<f64> = values.iter().map(|v| ratio * v[2]).collect();
    let delivered: Vec<f64> = values.iter().map(|v| v[3]).collect();
    let lost: Vec<f64> = supplied.iter().zip(&delivered).map(|(a, b)| a - b).collect();
    let mut lines: Vec<String> = (0..3)
        .map(|i| {
            format!(
                "{} rpm: N tau_1 - tau_2 = {:.4} N m, {:.2} % of N tau_1; tau_2 / output speed = {:.4} N m s/rad",
                system[i].rpm(),
                lost[i],
                100.0 * lost[i] / supplied[i],
                delivered[i] / speeds[i]
            )
        })
        .collect();
    let ones = vec![1.0; 3];
    for (name, shape) in [
        ("proportional to the torque", &supplied),
        ("constant", &ones),
        ("proportional to the speed", &speeds),
    ] {
        let (factor, rest) = through_nought(shape, &lost);
        lines.push(format!("loss {name}: factor {}, misses by {:.4} N m rms", short(factor), rest));
    }
    let (drag, rest) = through_nought(&speeds, &delivered);
    lines.push(format!(
        "load as viscous drag: c5 = {} N m s/rad, misses tau_2 by {rest:.3} N m rms",
        short(drag)
    ));
    let (fraction, rest) = through_nought(&supplied, &lost);
    let shares: Vec<f64> = (0..3).map(|i| 100.0 * lost[i] / supplied[i]).collect();
    let conclusion = format!(
        "Concealed: a loss proportional to the torque, {:.2} % of it ({}), which eq. 3.5 leaves out and which explains the three rows to \
         {rest:.3} N m; and a load that weakens from {} to {} N m while the speed trebles, which no viscous c5 does: dry friction that \
         falls with speed, a brake, or heating. In a steady state a mesh loss and a wrong gain of either torque sensor ({:.2} %) look \
         alike; only a recording in which the direction of power changes tells them apart.",
        100.0 * fraction,
        list(&shares, 2),
        system[0].printed[4].text,
        system[2].printed[4].text,
        100.0 * fraction
    );
    report.point(
        11,
        Verdict::Concealed,
        "A loss proportional to the torque, and a load that weakens with speed",
        lines,
        conclusion,
    );
}

/// Least-squares factor of a shape, and the root mean square residual.
fn through_nought(shape: &[f64], values: &[f64]) -> (f64, f64) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let factor = dot(shape, values) / dot(shape, shape);
    let squares: f64 = shape.iter().zip(values).map(|(s, v)| (v - factor * s).powi(2)).sum();
    (factor, (squares / values.len() as f64).sqrt())
}
