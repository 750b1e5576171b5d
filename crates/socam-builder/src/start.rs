//! Start values of inertias without a size: torque over acceleration in a recording.

use nalgebra::{DMatrix, DVector};
use socam_model::{Model, Motion, Quantity};
use socam_recording::Dataset;

use crate::{
    DescribeError,
    machine::Machine,
    sizes::{Parameter, Trust, rounded},
};

/// Windows over which the torque's impulse is compared with the change of speed.
const WINDOWS: usize = 200;
/// Fewest samples of a window.
const LEAST_SAMPLES: usize = 5;

/// Replaces usual inertias by what the recording gives, and says what it did.
pub(crate) fn from_recording(
    machine: &mut Machine,
    model: &Model,
    data: &Dataset,
) -> Result<Vec<String>, DescribeError> {
    let is_usual = |machine: &Machine, node: usize| {
        machine.nodes[node].inertia.as_ref().is_some_and(|own| own.trust == Trust::Usual && !own.fixed)
    };
    let unknown: Vec<usize> = (0..machine.nodes.len()).filter(|node| is_usual(machine, *node)).collect();
    if unknown.is_empty() {
        return Ok(Vec::new());
    }
    let names: Vec<&str> = unknown.iter().map(|node| machine.nodes[*node].name.as_str()).collect();
    let names = names.join(", ");
    let kept = |why: &str| Ok(vec![format!("the inertia of {names} keeps its typical start value: {why}")]);
    let torque = model.inputs().find(|input| input.quantity == Quantity::Torque);
    let Some(torque) = torque else { return kept("no torque drives the model") };
    let moved = model.outputs().find(|output| {
        output.at == torque.at && matches!(output.quantity, Quantity::Speed | Quantity::Angle)
    });
    let Some(moved) = moved else { return kept("no speed or angle is measured where the torque acts") };
    let loaded = data.load(&[&torque.column, &moved.column])?;
    let read = |index: usize, scale: f64, offset: f64| -> Vec<f64> {
        loaded.columns[index].values().iter().map(|value| scale * value + offset).collect()
    };
    let motion = read(1, moved.scale, moved.offset);
    let motion = Moved { values: &motion, is_angle: moved.quantity == Quantity::Angle };
    let efforts = read(0, torque.scale, torque.offset);
    let Some(total) = total_inertia(&loaded.time_s, &efforts, &motion) else {
        return kept("torque and acceleration of the recording give none");
    };
    // Inertia at the driven node = sum of inertia / ratio^2.
    let share = |node: usize| {
        model.rigid_ratio(&torque.at, &machine.nodes[node].name).map_or(1.0, |ratio| 1.0 / (ratio * ratio))
    };
    let known = (0..machine.nodes.len()).filter(|node| !unknown.contains(node));
    let known: f64 = known.filter_map(|n| Some(machine.nodes[n].inertia.as_ref()?.si() * share(n))).sum();
    let left = (total - known) / unknown.len() as f64;
    if left <= 0.02 * total {
        return kept("the recording's torque over acceleration is no more than the inertias that are given");
    }
    let unit = if model.motion == Motion::Rotation { "kg m2" } else { "kg" };
    let starts: Vec<(usize, f64)> = unknown.iter().map(|node| (*node, left / share(*node))).collect();
    for (node, start) in starts {
        let source = format!(
            "the recording's torque over acceleration at {}: {} {unit} in all",
            torque.at,
            rounded(total)
        );
        let ends = (10.0, 10.0);
        let start = Parameter { trust: Trust::Recorded, ..Parameter::computed(start, unit, ends, source) };
        machine.nodes[node].inertia = Some(start);
    }
    Ok(vec![format!(
        "the inertia of {names} starts from torque over acceleration at {}: {} {unit} in all",
        torque.at,
        rounded(total)
    )])
}

/// A measured speed, or an angle.
struct Moved<'v> {
    values: &'v [f64],
    is_angle: bool,
}

impl Moved<'_> {
    fn speed(&self, row: usize, time_s: &[f64]) -> f64 {
        if !self.is_angle {
            return self.values[row];
        }
        let (before, after) = (row.saturating_sub(2), (row + 2).min(self.values.len() - 1));
        (self.values[after] - self.values[before]) / (time_s[after] - time_s[before])
    }
}

/// Inertia that a torque accelerates, by least squares of the changes of speed over windows against the impulses of the torque, of a drag
/// that is proportional to speed, and of a friction of constant magnitude. The impulse of a torque has little noise, so that noise does
/// not bias the inertia as it would as a factor of the acceleration.
fn total_inertia(time_s: &[f64], torque: &[f64], motion: &Moved<'_>) -> Option<f64> {
    let rows = time_s.len();
    let step = (rows / WINDOWS).max(LEAST_SAMPLES);
    let windows = rows.checked_sub(5)? / step;
    if windows < 8 {
        return None;
    }
    let impulse = |from: usize, to: usize, value: &dyn Fn(usize) -> f64| -> f64 {
        (from..to).map(|k| 0.5 * (value(k) + value(k + 1)) * (time_s[k + 1] - time_s[k])).sum()
    };
    let speed = |row: usize| motion.speed(row, time_s);
    let ends = |window: usize| (window * step, (window + 1) * step);
    let causes = DMatrix::from_fn(windows, 4, |window, column| {
        let (from, to) = ends(window);
        match column {
            0 => impulse(from, to, &|k| torque[k]),
            1 => impulse(from, to, &speed),
            2 => impulse(from, to, &|k| speed(k).signum()),
            _ => time_s[to] - time_s[from],
        }
    });
    let change = DVector::from_fn(windows, |window, _| {
        let (from, to) = ends(window);
        speed(to) - speed(from)
    });
    if causes.iter().chain(&change).any(|value| !value.is_finite()) {
        return None;
    }
    let solved = causes.svd(true, true).solve(&change, 1e-12).ok()?;
    let inverse = solved[0];
    (inverse.is_finite() && inverse > 0.0).then(|| 1.0 / inverse)
}
