//! Tables 4.2, 4.4 and 4.8 and the numbers in eq. 4.7; points 7, 18 and 19.

use socam_frequency::matching::Equations;

use super::equations::{EQUATIONS, Printed47, values};
use crate::{
    Printed, Thesis,
    report::{Report, Row, Verdict, row, short},
};

pub(super) fn characteristic(thesis: &Thesis, report: &mut Report) {
    let data = &thesis.matching;
    let stiffness = data.torque_Nmm.value / (data.speed_deg_s.value * data.time_constant_s.value);
    let damping = (data.motor_inertia.value * stiffness).sqrt();
    report.table(
        "Table 4.2",
        "Characteristic stiffness and damping",
        vec![
            row(
                "k_char",
                "N mm/deg",
                &data.k_char,
                stiffness,
                0.0,
                format!(
                    "{} / ({} x {})",
                    data.torque_Nmm.text, data.speed_deg_s.text, data.time_constant_s.text
                ),
            ),
            row(
                "c_char",
                "N mm s/deg",
                &data.c_char,
                damping,
                0.0,
                format!("sqrt({} x {})", data.motor_inertia.text, short(stiffness)),
            ),
        ],
    );
}

/// The constants of eq. 4.7, and point 19.
pub(super) fn constants(thesis: &Thesis, report: &mut Report, equations: &Printed47) {
    let data = &thesis.matching;
    let norms = equations.norms();
    let constant = |i: usize| data.right_sides[i].value.abs() / norms[i];
    let rows = (0..EQUATIONS).map(|i| {
        let calculation = format!("|{}| / {}", data.right_sides[i].text, short(norms[i]));
        row(format!("phi_{}", i + 1), "1", &data.constants[i], constant(i), 1e-4, calculation)
    });
    report.table("Eq. 4.7a to 4.7j", "Constants of the dimensionless equations", rows.collect());
    report.point(
        19,
        Verdict::Refuted,
        "The constant of eq. 4.7j was divided by another k_char than the others",
        vec![
            format!(
                "{} / (N^2 k_char^4) = {}, printed {}",
                data.right_sides[9].text,
                short(constant(9)),
                data.constants[9].text
            ),
            format!(
                "the printed one needs k_char = {}; Table 4.2 has {}",
                short((data.right_sides[9].value / (64.0 * data.constants[9].value)).powf(0.25)),
                data.k_char.text
            ),
            format!("it is {:.1} % too small", 100.0 * (1.0 - data.constants[9].value / constant(9))),
        ],
        "Eq. 4.7a to 4.7i follow with the k_char of Table 4.2, eq. 4.7j with 8: it asks for less static stiffness than eq. 4.4j does.",
    );
}

/// 1 kg mm2 in N mm s2/deg.
const KGMM2: f64 = 1e-3 * std::f64::consts::PI / 180.0;

/// The coefficients of eq. 4.7 with their formulas, for inertias multiplied by `scale`.
fn coefficients_of(equations: &Printed47, scale: f64) -> Vec<(&'static str, f64)> {
    let (k, c, n) = (equations.stiffness, equations.damping, equations.bench.ratio);
    let (cam, load) = (scale * equations.cam(), scale * equations.bench.load);
    vec![
        ("c_char^2 / (J4 k_char)", c * c / (load * k)),
        ("N^2 c_char^2 / ((J2 N^2 + J3) k_char)", n * n * c * c / (cam * k)),
        ("N^2 J4 / (J2 N^2 + J3)", n * n * load / cam),
        ("1 + J4 / (J2 N^2 + J3)", 1.0 + load / cam),
        ("k_char J4 / c_char^2", k * load / (c * c)),
        ("(J2 N^2 + J3 + J4) / (N^2 J4)", (cam + load) / (n * n * load)),
        ("N^2 J4 / (J2 N^2 + J3 + J4)", n * n * load / (cam + load)),
        ("1 / N^2", 1.0 / (n * n)),
    ]
}

/// The coefficients of eq. 4.7, and point 18.
pub(super) fn coefficients(thesis: &Thesis, report: &mut Report, equations: &Printed47) {
    let data = &thesis.matching;
    let (printed, proper) = (coefficients_of(equations, 1.0), coefficients_of(equations, KGMM2));
    let rows = data.coefficients.iter().zip(&printed).map(|(coefficient, (formula, ours))| {
        let what = format!("{}, factor of {}", coefficient.equation, coefficient.term);
        row(what, "1", &coefficient.value, *ours, 3e-4, format!("{formula}, inertias in kg mm2"))
    });
    report.table("Eq. 4.7e to 4.7i", "Coefficients of the dimensionless equations", rows.collect());
    let lines = printed
        .iter()
        .zip(&proper)
        .zip(&data.coefficients)
        .filter(|((as_printed, right), _)| as_printed.1 != right.1);
    let mut lines: Vec<String> = lines
        .filter(|((as_printed, right), _)| (as_printed.1 / right.1 - 1.0).abs() > 1e-9)
        .map(|((as_printed, right), coefficient)| {
            format!(
                "{} = {} with J in kg mm2 (printed {}), {} with J in N mm s2/deg",
                as_printed.0,
                short(as_printed.1),
                coefficient.value.text,
                short(right.1)
            )
        })
        .collect();
    lines.insert(
        0,
        format!(
            "1 kg mm2 = 1e-3 x pi/180 N mm s2/deg: the inertias are {} times too large",
            short(1.0 / KGMM2)
        ),
    );
    report.point(
        18,
        Verdict::Refuted,
        "The inertias enter eq. 4.7 in kg mm2, beside stiffnesses in N mm/deg",
        lines,
        "Every equation that holds an inertia mixes units, so that no solution of eq. 4.9 can be this bench's parameters, whatever the \
         weights.",
    );
}

pub(super) fn weights(thesis: &Thesis, report: &mut Report, equations: &Printed47) {
    let data = &thesis.matching;
    let errors = equations.errors(&values(&data.initial));
    let rows = |printed: &[Printed; EQUATIONS], power: i32| -> Vec<Row> {
        let name = if power == 2 { "1 / phi^2" } else { "1 / |phi|" };
        let one = |i: usize| {
            let ours = errors[i].abs().powi(-power);
            row(
                format!("w_{}", i + 1),
                "1",
                &printed[i],
                ours,
                1e-3,
                format!("{name}, phi_{}(x0) = {}", i + 1, short(errors[i])),
            )
        };
        (0..EQUATIONS).map(one).collect()
    };
    report.table("Table 4.4", "Weights 1/phi(x0)^2", rows(&data.weights_1, 2));
    report.table("Table 4.8", "Weights 1/|phi(x0)|", rows(&data.weights_2, 1));
    let [first, second] = [values(&data.weights_1), values(&data.weights_2)];
    let square = |i: usize| second[i].powi(2);
    let others: Vec<String> = (0..EQUATIONS)
        .filter(|i| (square(*i) / first[*i] - 1.0).abs() > 0.01)
        .map(|i| {
            format!(
                "; but w_{}, where {}^2 = {}, not {}",
                i + 1,
                data.weights_2[i].text,
                short(square(i)),
                data.weights_1[i].text
            )
        })
        .collect();
    let ratio = (0..EQUATIONS).map(|i| errors[i].powi(2) * first[i]);
    let (least, most) = ratio.fold((f64::INFINITY, 0.0_f64), |(l, m), r| (l.min(r), m.max(r)));
    report.point(
        7,
        Verdict::Refuted,
        "The weights are not those of the initial guess",
        vec![
            format!(
                "phi_10(x0) = {}, so w_10 = {}; printed {}",
                short(errors[9]),
                short(errors[9].powi(-2)),
                data.weights_1[9].text
            ),
            format!("w_i phi_i(x0)^2 should be 1 and runs from {} to {}", short(least), short(most)),
            format!("Table 4.8 is the root of Table 4.4{}", others.concat()),
        ],
        "Both tables come from one set of phi, which the printed equations do not have at the printed guess.",
    );
}
