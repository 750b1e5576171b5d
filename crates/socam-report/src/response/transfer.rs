//! Bode plots, and plots of poles and zeros.

use socam_frequency::{
    Complex,
    rational::{Fit, Point, TransferFunction, response_std_among},
};
use socam_plot::{Axis, Mark};

use super::pictures::{Curve, Drawn, Picture, decibels, frequency, unwrapped};

/// Ratio of a root to the highest line above which the root is not drawn, since it would compress the scale.
const FAR: f64 = 3.0;

/// Plots of magnitude and phase of a transfer function with its data, and of its poles and zeros.
/// `fits`: the first is drawn; the others only widen its interval.
#[must_use]
pub fn transfer(name: &str, fits: &[Fit], points: &[Point]) -> Vec<Picture> {
    let Some(Fit { transfer, .. }) = fits.first() else { return Vec::new() };
    let mut bode = bode(&format!(" of {name}"), points, &[("fit", "before", transfer)], true);
    // The interval of the fit, behind data and fit: relative magnitude in dB, phase in degrees.
    let units = [20.0 * std::f64::consts::LOG10_E, 1f64.to_degrees()];
    for (index, (picture, unit)) in bode.iter_mut().zip(units).enumerate() {
        let curves = &mut picture.plot.curves;
        let Some(fitted) = curves.last() else { continue };
        let spread = fitted.x.iter().map(|hz| 1.96 * unit * response_std_among(fits, *hz)[index]).collect();
        let (x, y) = (fitted.x.clone(), fitted.y.clone());
        let label = "95 % interval".into();
        curves.insert(0, Curve { label, class: "before", mark: Mark::Band, x, y, spread });
    }
    let [magnitude, phase] = bode;
    let highest = points.iter().map(|point| point.frequency_hz).fold(0.0, f64::max);
    let curve = |label: &str, class, mark, roots: Vec<Complex<f64>>| {
        let (near, far): (Vec<Complex<f64>>, Vec<Complex<f64>>) =
            roots.into_iter().partition(|root| root.norm() <= FAR * std::f64::consts::TAU * highest);
        let (x, y) = near.iter().map(|root| (root.re, root.im)).unzip();
        let label =
            if far.is_empty() { label.into() } else { format!("{label} ({} farther out)", far.len()) };
        Curve { label, class, mark, x, y, spread: Vec::new() }
    };
    let map = Drawn {
        title: format!("Poles and zeros of {name}"),
        x: Axis::new("Real part", "1/s"),
        y: Axis::new("Imaginary part", "1/s"),
        curves: vec![
            curve("poles", "before", Mark::Crosses, transfer.poles()),
            curve("zeros", "after", Mark::Points, transfer.zeros()),
        ],
    };
    vec![magnitude, phase, Picture { name: "poles-zeros", plot: map }]
}

/// Magnitude and phase of transfer functions with the data that they match.
#[must_use]
pub fn matched(fits: &[(String, TransferFunction)], points: &[Point]) -> Vec<Picture> {
    let classes = ["before", "third", "noise"];
    let fits: Vec<_> = fits
        .iter()
        .zip(classes)
        .map(|((label, transfer), class)| (label.as_str(), class, transfer))
        .collect();
    bode("", points, &fits, false).into()
}

/// `near`: the first fit is close to the data, so that their phases are unwrapped along it.
fn bode(
    of: &str,
    points: &[Point],
    fits: &[(&str, &'static str, &TransferFunction)],
    near: bool,
) -> [Picture; 2] {
    let ends = points.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), point| {
        (low.min(point.frequency_hz), high.max(point.frequency_hz))
    });
    let grid: Vec<f64> = (0..300).map(|i| ends.0 * (ends.1 / ends.0).powf(f64::from(i) / 299.0)).collect();
    let at: Vec<f64> = points.iter().map(|point| point.frequency_hz).collect();
    let measured: Vec<Complex<f64>> = points.iter().map(|point| point.output / point.input).collect();
    let mut phases = unwrapped(&measured);
    if let Some((.., transfer)) = fits.first().filter(|_| near) {
        let fitted: Vec<Complex<f64>> = at.iter().map(|hz| transfer.response(*hz)).collect();
        let beside = unwrapped(&fitted);
        phases.iter_mut().zip(beside).for_each(|(own, fit)| *own -= 360.0 * ((*own - fit) / 360.0).round());
    }
    let data = |y| Curve {
        label: "data".into(),
        class: "after",
        mark: Mark::Points,
        x: at.clone(),
        y,
        spread: Vec::new(),
    };
    let mut magnitudes = vec![data(decibels(&measured))];
    let mut angles = vec![data(phases.clone())];
    for (label, class, transfer) in fits {
        let fitted: Vec<Complex<f64>> = grid.iter().map(|hz| transfer.response(*hz)).collect();
        let mut phase = unwrapped(&fitted);
        // Shifted by whole turns to the first data point.
        let off = phases
            .first()
            .zip(phase.first())
            .map_or(0.0, |(data, own)| 360.0 * ((data - own) / 360.0).round());
        phase.iter_mut().for_each(|degrees| *degrees += off);
        let curve = |y| Curve {
            label: (*label).to_owned(),
            class,
            mark: Mark::Line,
            x: grid.clone(),
            y,
            spread: Vec::new(),
        };
        magnitudes.push(curve(decibels(&fitted)));
        angles.push(curve(phase));
    }
    let drawn =
        |title: &str, y: Axis, curves| Drawn { title: format!("{title}{of}"), x: frequency(), y, curves };
    [
        Picture { name: "magnitude", plot: drawn("Magnitude", Axis::new("Magnitude", "dB"), magnitudes) },
        Picture { name: "phase", plot: drawn("Phase", Axis::new("Phase", "degrees"), angles) },
    ]
}
