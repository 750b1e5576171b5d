//! The bench's transfer function in consistent units: points 6, 8 and 20.

use socam_frequency::{
    Complex,
    chebyshev::economise,
    matching::{self, UNKNOWNS, direct, solve},
    rational::TransferFunction,
};

use super::equations::{EQUATIONS, values};
use crate::{
    Printed, Thesis,
    report::{Report, Verdict, short},
    transfer,
};

/// Table 4.6 or 4.10 in SI.
fn in_si(parameters: &[Printed; UNKNOWNS]) -> [f64; UNKNOWNS] {
    values(parameters).map(|value| value.to_degrees())
}

pub(super) fn poles(thesis: &Thesis, report: &mut Report) {
    let bench = transfer::bench(thesis);
    let etf = transfer::measured(thesis);
    let list = |of: &TransferFunction| -> String {
        let poles: Vec<String> =
            of.poles().iter().filter(|pole| pole.im >= 0.0).map(|pole| complex(*pole)).collect();
        poles.join(", ")
    };
    let lines = vec![
        format!("ETF: {}", list(&etf)),
        format!("Table 4.6: {}", list(&bench.transfer(&in_si(&thesis.matching.parameters_1)))),
        format!("Table 4.10: {}", list(&bench.transfer(&in_si(&thesis.matching.parameters_2)))),
    ];
    report.point(
        6,
        Verdict::Refuted,
        "Table 4.6 does not have the ETF's poles",
        lines,
        "The identified parameters, put back into the model in consistent units, are another bench.",
    );
}

fn complex(value: Complex<f64>) -> String {
    if value.im == 0.0 {
        format!("{:.2} 1/s", value.re)
    } else {
        format!("{:.2} +- {:.2}i 1/s", value.re, value.im)
    }
}

/// Point 8: parameters that the transfer function does not determine.
pub(super) fn identifiability(thesis: &Thesis, report: &mut Report) {
    let bench = transfer::bench(thesis);
    let catalogue = thesis.couplings.catalogue_Nm_per_deg.each_ref().map(|p| p.value.to_degrees());
    let k3 = thesis.matching.parameters_1[2].value.to_degrees();
    let at = [catalogue[0], catalogue[1], k3, catalogue[2], 0.02, 0.03, 0.08, 0.05];
    let swapped = [at[1], at[0], at[2], at[3], at[5], at[4], at[6], at[7]];
    let grid = || (0..120).map(|i| 0.5 * 200_f64.powf(f64::from(i) / 119.0));
    let change = |other: &[f64; UNKNOWNS]| {
        let ratio = |hz: f64| (bench.transfer(other).response(hz) / bench.transfer(&at).response(hz)).norm();
        grid().map(|hz| 20.0 * ratio(hz).log10().abs()).fold(0.0, f64::max)
    };
    let with_k3 = |factor: f64| std::array::from_fn(|i| if i == 2 { factor * at[2] } else { at[i] });
    let points = bench.transfer(&at).measured([0.5, 100.0], 120, 0.01);
    let fit = direct(&bench, &points, &at);
    let guess = values(&thesis.matching.initial)[2];
    let moved = 100.0 * (values(&thesis.matching.solution_1)[2] / guess - 1.0);
    report.point(
        8,
        Verdict::Refuted,
        "k1, k2, c2, c3 and the headline k3 are not identifiable from this transfer function",
        vec![
            format!("(k1, c2) and (k2, c3) swapped: the response changes by {:.1e} dB", change(&swapped)),
            format!("k3 ten times as stiff: it changes by at most {:.4} dB up to 100 Hz; at half of k3, by {:.4} dB", change(&with_k3(10.0)), change(&with_k3(0.5))),
            format!(
                "120 lines from 0.5 to 100 Hz known to 1 %: relative standard deviation of k1 {}, of k3 {}, of the couplings' series stiffness {}",
                short(fit.relative_std[0]), short(fit.relative_std[2]), short(fit.series_relative_std)
            ),
            format!("the printed k3 is {moved:+.2} % from its initial guess of {}", thesis.matching.initial[2].text),
        ],
        "Only the series stiffness of couplings 1 and 2 is firm; k3 stayed where it was put. A locked output with an angle sensor would \
         measure k3; a torsion test of either coupling would separate k1 from k2.",
    );
}

/// Point 20: the parameters of the bench that match the ETF in consistent units.
pub(super) fn properly(thesis: &Thesis, report: &mut Report) {
    let bench = transfer::bench(thesis);
    let etf = transfer::measured(thesis);
    let cut = TransferFunction { numerator: economise(&etf.numerator, 3).coefficients, ..etf.clone() };
    let catalogue = thesis.couplings.catalogue_Nm_per_deg.each_ref().map(|p| p.value.to_degrees());
    let k3 = values(&thesis.matching.initial)[2] * thesis.matching.k_char.value * 1e-3;
    let start = [catalogue[0], catalogue[1], k3.to_degrees(), catalogue[2], 0.02, 0.02, 0.08, 0.05];
    let equations = bench.equations(&cut);
    let found = solve(&equations, &[1.0; EQUATIONS], &start);
    let mut lines: Vec<String> = equations
        .names()
        .iter()
        .zip(equations.ratios(&found.at))
        .map(|(name, ratio)| {
            format!("{name}: the best match is {} of the ETF's", short((1e4 * ratio).round() / 1e4))
        })
        .collect();
    lines.insert(
        0,
        format!(
            "H(0) of the ETF is {}; P(0)/Q(0) of the model is 1/N = {} whatever its parameters",
            short(etf.final_value()),
            short(1.0 / bench.ratio)
        ),
    );
    let points = etf.measured([0.5, 100.0], 120, 0.01);
    let fit = direct(&bench, &points, &start);
    let series = |at: &[f64; UNKNOWNS]| matching::combinations(at)[0].value.to_radians();
    lines.push(format!("series stiffness of couplings 1 and 2: matched {} N m/deg, fitted to the response {} N m/deg, catalogue {} N m/deg", short(series(&found.at)), short(series(&fit.at)), short(series(&start))));
    lines.push(format!(
        "coupling 3: matched {} N m/deg, fitted to the response {} N m/deg, measured {} N m/deg",
        short(found.at[3].to_radians()),
        short(fit.at[3].to_radians()),
        thesis.couplings.measured_Nm_per_deg[2].text
    ));
    lines.push(format!(
        "fitted directly to the ETF's response from 0.5 to 100 Hz, from the catalogue on, the model still misses it by {:.1} % rms",
        fit.misfit
    ));
    report.point(
        20,
        Verdict::Refuted,
        "In consistent units the ETF cannot be this model's transfer function",
        lines,
        "No positive parameters make the numerator's s^3 negative, and none a final value other than 1/N (that one a measurement may miss by \
         as much). The ratios are those of one compromise, in which all ten coefficients weigh alike; other weights share the misfit out \
         otherwise, and none takes it away. The direct fit is the best that was found from the catalogue on, not proven to be the best there is.",
    );
}
