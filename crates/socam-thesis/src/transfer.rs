//! Section 4.1: the experimental transfer function; points 1, 2 and 4.

use std::f64::consts::TAU;

use socam_frequency::{
    chebyshev::economise,
    matching::{Bench, Coefficients, UNKNOWNS},
    polynomial,
    rational::TransferFunction,
};

use crate::{
    Printed, Thesis,
    report::{Report, Verdict, row, short},
};

/// Coefficients as printed, descending, to ascending numbers.
fn ascending(printed: &[Printed]) -> Vec<f64> {
    printed.iter().rev().map(|p| p.value).collect()
}

/// The experimental transfer function (ETF).
pub(crate) fn measured(thesis: &Thesis) -> TransferFunction {
    TransferFunction {
        numerator: ascending(&thesis.transfer.numerator),
        denominator: ascending(&thesis.transfer.denominator),
    }
}

/// The bench in SI.
pub(crate) fn bench(thesis: &Thesis) -> Bench {
    let si = |printed: &Printed| 1e-6 * printed.value;
    Bench {
        cam_shaft: si(&thesis.inertia.cam_shaft_kgmm2),
        disk: si(&thesis.inertia.disk_kgmm2),
        load: si(&thesis.inertia.load_kgmm2),
        ratio: thesis.hardware.ratio.value,
    }
}

pub(crate) fn examine(thesis: &Thesis, report: &mut Report) {
    let data = &thesis.transfer;
    let transfer = measured(thesis);
    let calculation = format!("{} / {}", data.numerator[5].text, data.denominator[6].text);
    report.table(
        "Section 4.1.1",
        "Final value of the transfer function",
        vec![row("H(0)", "1", &data.final_value, transfer.final_value(), 0.0, calculation)],
    );
    factors(thesis, report);
    modes(thesis, report);
    economisation(thesis, report);
    sign(thesis, report);
}

/// The factors, from the denominator's roots.
fn factors(thesis: &Thesis, report: &mut Report) {
    let poles = measured(thesis).poles();
    let real: Vec<f64> = poles.iter().filter(|pole| pole.im == 0.0).map(|pole| pole.re).collect();
    let mut pairs: Vec<[f64; 2]> =
        poles.iter().filter(|pole| pole.im > 0.0).map(|pole| [-2.0 * pole.re, pole.norm_sqr()]).collect();
    if let [a, b] = real[..] {
        pairs.insert(0, [-(a + b), a * b]);
    }
    // The denominator is printed with four digits, so that its factors follow from it to 0.1 % only.
    let rows = thesis.transfer.factors.iter().zip(&pairs).enumerate().flat_map(|(i, (printed, ours))| {
        let from = "roots of D(s)";
        [
            row(format!("M{}, coefficient of s", i + 1), "1/s", &printed[0], ours[0], 2e-3, from),
            row(format!("M{}, constant", i + 1), "1/s2", &printed[1], ours[1], 2e-3, from),
        ]
    });
    report.table("Section 4.1.1", "Factors of the denominator", rows.collect());
}

fn modes(thesis: &Thesis, report: &mut Report) {
    let data = &thesis.transfer;
    let mode = |factor: &[Printed; 2]| {
        let natural = factor[1].value.sqrt();
        (natural / TAU, factor[0].value / (2.0 * natural))
    };
    let rows = (0..3).flat_map(|i| {
        let (frequency, damping) = mode(&data.factors[i]);
        let [b, c] = &data.factors[i];
        [
            row(
                format!("mode {}, natural frequency", i + 1),
                "Hz",
                &data.natural_frequencies_hz[i],
                frequency,
                6e-4,
                format!("sqrt({}) / 2 pi", c.text),
            ),
            row(
                format!("mode {}, damping ratio", i + 1),
                "1",
                &data.damping_ratios[i],
                damping,
                6e-4,
                format!("{} / (2 sqrt({}))", b.text, c.text),
            ),
        ]
    });
    report.table("Table 4.1", "Natural frequencies and damping ratios, from the factors", rows.collect());
    let frequencies = data.factors.each_ref().map(|factor| mode(factor).0);
    let (first, damping) = mode(&data.factors[0]);
    let poles = polynomial::roots(&[data.factors[0][1].value, data.factors[0][0].value, 1.0]);
    report.point(
        2,
        Verdict::Refuted,
        "The first mode is at 20.20 Hz by its own factor, and is no resonance",
        vec![
            format!("sqrt({}) / 2 pi = {first:.2} Hz, printed {} Hz", data.factors[0][1].text, data.natural_frequencies_hz[0].text),
            format!("all three: {:.2}, {:.2}, {:.2} Hz", frequencies[0], frequencies[1], frequencies[2]),
            format!("zeta = {damping:.4} > 1: two real poles, {:.2} and {:.2} 1/s", poles[0].re, poles[1].re),
        ],
        "A damping ratio above 1 has no natural frequency that anything oscillates at; the two other modes hold.",
    );
}

fn economisation(thesis: &Thesis, report: &mut Report) {
    let data = &thesis.transfer;
    let numerator = ascending(&data.numerator);
    let mut rows = Vec::new();
    for (degree, printed) in [(4, &data.economised_4[..]), (3, &data.economised_3[..])] {
        let ours = economise(&numerator, degree).coefficients;
        for (power, printed) in (0..=degree).rev().zip(printed) {
            rows.push(row(
                format!("degree {degree}: coefficient of s^{power}"),
                "",
                printed,
                ours[power],
                0.0,
                format!("Chebyshev polynomials taken off down to degree {degree}"),
            ));
        }
    }
    report.table("Section 4.1.2, eq. 4.2", "Economised numerator", rows);
    let cut = TransferFunction {
        numerator: economise(&numerator, 3).coefficients,
        denominator: ascending(&data.denominator),
    };
    let whole = measured(thesis);
    let economised = economise(&numerator, 3);
    let mut lines = vec![
        format!("on [-1, 1] at most {} of {} is dropped", short(economised.bound), data.numerator[5].text),
        format!(
            "the s^3 term stays {}; printed in eq. 4.2: {}",
            short(cut.numerator[3]),
            data.economised_3[0].text
        ),
        format!(
            "the s term stays {}; printed in eq. 4.2: {}",
            short(cut.numerator[1]),
            data.economised_3[2].text
        ),
    ];
    for hz in [10.0, 35.0, 135.0] {
        let ratio = cut.response(hz) / whole.response(hz);
        lines.push(format!(
            "at {hz} Hz, |s| = {:.0} 1/s: {:+.2} dB, {:+.1} degrees from the ETF",
            TAU * hz,
            20.0 * ratio.norm().log10(),
            ratio.arg().to_degrees()
        ));
    }
    let sizes: Vec<String> = whole.poles().iter().map(|pole| format!("{:.0}", pole.norm())).collect();
    lines.push(format!(
        "the poles lie at |s| = {} 1/s; the approximation holds for |s| <= 1",
        sizes.join(", ")
    ));
    report.point(
        4,
        Verdict::Refuted,
        "The economised numerator is misprinted, and economised where the bench is not",
        lines,
        "On [-1, 1] what is dropped does not matter; at the bench's poles it does. The tenfold s^3 coefficient went on into eq. 4.4a.",
    );
}

/// Point 1: the sign of the s^3 term.
fn sign(thesis: &Thesis, report: &mut Report) {
    let bench = bench(thesis);
    // Arbitrary parameters.
    let at: [f64; UNKNOWNS] = [70.0, 50.0, 5e4, 100.0, 0.02, 0.03, 0.1, 0.05];
    let Coefficients { numerator, .. } = bench.coefficients(&at);
    let expected = at[2] * bench.ratio * at[4] * at[5] * at[6];
    report.point(
        1,
        Verdict::Refuted,
        "Eq. 3.10a: the s^3 term is + c2 c3 c4",
        vec![
            "P(s) = k3 N (k1 + c2 s)(k2 + c3 s)(k4 + c4 s), the cofactor of the equations of motion".into(),
            format!("at k = (70, 50, 5e4, 100), c = (0.02, 0.03, 0.1, 0.05): s^3 of P is {}, k3 N c2 c3 c4 is {}", short(numerator[3]), short(expected)),
            format!("the ETF has {} s^3, {} s^4 and {} s^5", thesis.transfer.numerator[2].text, thesis.transfer.numerator[1].text, thesis.transfer.numerator[0].text),
        ],
        "The minus sign only serves to meet the ETF's negative coefficient. No positive damping has one: the ETF is not of this model.",
    );
}
