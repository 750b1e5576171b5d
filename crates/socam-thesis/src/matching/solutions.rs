//! Tables 4.5 to 4.10: solutions of the least squares, and points 5 and 9.

use socam_frequency::matching::{Equations, NAMES, UNKNOWNS, solve};

use super::equations::{EQUATIONS, Printed47, values};
use crate::data::Matching;
use crate::{
    Printed, Thesis,
    report::{Report, Row, Verdict, row, short},
};

const DIMENSIONLESS: [&str; UNKNOWNS] =
    ["kappa_1", "kappa_2", "kappa_3", "kappa_4", "gamma_2", "gamma_3", "gamma_4", "gamma_5"];

pub(super) fn solutions(thesis: &Thesis, report: &mut Report, equations: &Printed47) {
    let data = &thesis.matching;
    let tables = [
        ("Table 4.5", "Table 4.6", &data.weights_1, &data.solution_1, &data.minimum_1, &data.parameters_1),
        ("Table 4.9", "Table 4.10", &data.weights_2, &data.solution_2, &data.minimum_2, &data.parameters_2),
    ];
    for (place, physical, weights, solution, minimum, parameters) in tables {
        let (weights, theirs) = (values(weights), values(solution));
        let found = solve(equations, &weights, &values(&data.initial));
        let how = format!(
            "minimum of eq. 4.9 from Table 4.3 with the printed weights, {} programmes{}",
            found.steps,
            if found.converged { "" } else { ", not at rest" }
        );
        let mut rows: Vec<Row> = (0..UNKNOWNS)
            .map(|i| row(DIMENSIONLESS[i], "1", &solution[i], found.at[i], 5e-3, how.clone()))
            .collect();
        let errors = equations.errors(&theirs);
        let at_theirs: f64 = errors.iter().zip(weights).map(|(e, w)| 0.5 * w * e * e).sum();
        rows.push(row(
            "f at the printed solution",
            "1",
            minimum,
            at_theirs,
            1e-2,
            "eq. 4.9 with the printed weights",
        ));
        rows.push(row(
            "f at our minimum",
            "1",
            minimum,
            found.cost,
            1e-2,
            "eq. 4.9 with the printed weights",
        ));
        if place == "Table 4.5" {
            rows.extend(gradient_rows(data, equations, &weights, &theirs));
        }
        report.table(place, "Solution of the least squares", rows);
        report.table(physical, "Mechanical parameters", physical_rows(data, solution, parameters));
    }
}

/// The gradient of eq. 4.9 at the printed solution.
fn gradient_rows(
    data: &Matching,
    equations: &Printed47,
    weights: &[f64; EQUATIONS],
    solution: &[f64; UNKNOWNS],
) -> Vec<Row> {
    let errors = equations.errors(solution);
    let slopes = equations.slopes(solution);
    let gradient = |j: usize| (0..EQUATIONS).map(|i| weights[i] * errors[i] * slopes[i][j]).sum::<f64>();
    let one = |j: usize| {
        let what = format!("gradient, {}", DIMENSIONLESS[j]);
        row(what, "1", &data.gradient_1[j], gradient(j), 1e-2, "Phi^T W phi at the printed solution")
    };
    (0..UNKNOWNS).map(one).collect()
}

/// The printed solution with its units.
fn physical_rows(
    data: &Matching,
    solution: &[Printed; UNKNOWNS],
    parameters: &[Printed; UNKNOWNS],
) -> Vec<Row> {
    let convert = (0..UNKNOWNS).map(|i| {
        let (unit, characteristic) =
            if i < 4 { ("N m/deg", &data.k_char) } else { ("N m s/deg", &data.c_char) };
        let ours = 1e-3 * solution[i].value * characteristic.value;
        // The printed gammas have two digits.
        let share = solution[i].rounding();
        row(
            NAMES[i],
            unit,
            &parameters[i],
            ours,
            share,
            format!("{} x {} / 1000", solution[i].text, characteristic.text),
        )
    });
    convert.collect()
}

pub(super) fn couplings(thesis: &Thesis, report: &mut Report) {
    let data = &thesis.couplings;
    let error =
        |i: usize| 100.0 * (data.identified_Nm_per_deg[i].value / data.measured_Nm_per_deg[i].value - 1.0);
    let rows = (0..3).map(|i| {
        let calculation =
            format!("|{} / {} - 1|", data.identified_Nm_per_deg[i].text, data.measured_Nm_per_deg[i].text);
        row(
            format!("error of coupling {}", i + 1),
            "%",
            &data.errors_percent[i],
            error(i).abs(),
            1e-3,
            calculation,
        )
    });
    report.table("Table 4.7", "Identified beside measured stiffness", rows.collect());
    let (apparent, own) = (data.identified_Nm_per_deg[2].value, data.measured_Nm_per_deg[2].value);
    let series = 1.0 / (1.0 / apparent - 1.0 / own);
    report.point(
        9,
        Verdict::Concealed,
        "Coupling 3 came out too stiff; a compliant shaft would make it too soft",
        vec![
            format!("{apparent} / {own} - 1 = {:+.2} %", error(2)),
            format!("a shaft in series would need 1 / (1/{apparent} - 1/{own}) = {series:.2} N m/deg"),
            format!("a spring beside it would need {:.2} N m/deg", apparent - own),
        ],
        format!(
            "A compliance in series only lowers an apparent stiffness: the explanation has the wrong sign. Concealed is {:.2} N m/deg, \
             {:.1} % of the coupling, that acts like a spring beside it - or like an inertia that is less than assumed, for a frequency \
             tells only their ratio - or, since these numbers come from eq. 4.7, nothing but its mixed units (point 18).",
            apparent - own,
            error(2)
        ),
    );
}

pub(super) fn scale(thesis: &Thesis, report: &mut Report, equations: &Printed47) {
    let data = &thesis.matching;
    let theirs = equations.physical(&values(&data.solution_1));
    let sides = Printed47::pick(&equations.bench.coefficients(&theirs));
    let mut lines = vec![
        "a transfer function's numerator and denominator may both be multiplied by anything; eq. 4.4d fixes that factor to 1".to_owned(),
        "eq. 4.4 in the units of its solution, N mm/deg and N mm s/deg (point 18):".to_owned(),
    ];
    for i in [3, 5, 9] {
        lines.push(format!(
            "eq. 4.4{}: {} at Table 4.6, to be {}",
            (b'a' + i as u8) as char,
            short(sides[i]),
            data.right_sides[i].text
        ));
    }
    let monic = |i: usize| sides[i] / sides[3];
    lines.push(format!(
        "with the model's own leading coefficient divided out, s^4 is {} (to be {}) and s^0 {} (to be {})",
        short(monic(5)),
        data.right_sides[5].text,
        short(monic(9)),
        data.right_sides[9].text
    ));
    report.point(
        5,
        Verdict::Refuted,
        "Eq. 4.4 equates a transfer function that is not normalised with one that is",
        lines,
        "One condition too many, which is why ten equations were needed and why P(0) = Q(0)/N had to be left out.",
    );
}
