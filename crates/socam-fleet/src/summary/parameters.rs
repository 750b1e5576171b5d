//! Trends and differences of all parameters.

use super::{Different, Spread, Trend};
use crate::collected::Collected;
use crate::statistics::{
    median,
    sisters::{self, Value},
    trend::{self, Point, Sensitivity, Slope},
};

/// Days of a year.
const YEAR_DAYS: f64 = 365.25;

/// Results of all tests of parameters, before a selection by false discovery rate.
pub(super) struct Parameters {
    pub(super) trends: Vec<Trend>,
    pub(super) differences: Vec<Different>,
    pub(super) spreads: Vec<Spread>,
    /// Parameters that no recording determines.
    pub(super) undetermined: Vec<String>,
    /// Sensitivities by parameter, in the order of `spreads`.
    pub(super) sensitivities: Vec<Option<Sensitivity>>,
}

pub(super) fn parameters(all: &Collected) -> Parameters {
    let mut found = Parameters {
        trends: Vec::new(),
        differences: Vec::new(),
        spreads: Vec::new(),
        undetermined: Vec::new(),
        sensitivities: Vec::new(),
    };
    for (index, (name, unit)) in all.parameters.iter().enumerate() {
        let own: Vec<(&String, &Vec<Point>)> = all
            .machines
            .iter()
            .filter_map(|(machine, known)| Some((machine, known.estimates.get(&index)?)))
            .collect();
        if own.is_empty() {
            found.undetermined.push(name.clone());
            continue;
        }
        let points: Vec<Vec<Point>> = own.iter().map(|(_, points)| (*points).clone()).collect();
        let (slopes, dispersion) = trend::slopes(&points);
        let trends = own.iter().zip(&slopes).filter_map(|((machine, points), slope)| {
            Some(trend(machine, (name, unit), points.len(), slope.as_ref()?))
        });
        found.trends.extend(trends);
        let slopes: Vec<Slope> = slopes.into_iter().flatten().collect();
        found.sensitivities.push(Sensitivity::of(&slopes));
        let means: Vec<(&String, Value)> = own
            .iter()
            .filter_map(|(machine, points)| {
                let values: Vec<(f64, f64)> = points.iter().map(|point| (point.value, point.std)).collect();
                Some((*machine, Value::of(&values, dispersion)?))
            })
            .collect();
        let values: Vec<Value> = means.iter().map(|(_, value)| *value).collect();
        let each: Vec<_> = sisters::differences(&values);
        let mut between: Vec<f64> = each.iter().flatten().map(|one| one.between_std).collect();
        let each = means.iter().zip(each);
        found.differences.extend(each.filter_map(|((machine, value), difference)| {
            Some(different(machine, (name, unit), *value, difference?))
        }));
        let mut middle: Vec<f64> = values.iter().map(|value| value.mean).collect();
        found.spreads.push(Spread {
            parameter: name.clone(),
            unit: unit.clone(),
            machines: values.len(),
            median: median(&mut middle),
            between_std: Some(median(&mut between)).filter(|std| std.is_finite()),
            repeatability: dispersion.sqrt(),
            detectable_change: None,
        });
    }
    found
}

fn trend(machine: &str, (name, unit): (&str, &str), recordings: usize, slope: &Slope) -> Trend {
    Trend {
        machine: machine.to_owned(),
        parameter: name.to_owned(),
        unit: unit.to_owned(),
        recordings,
        per_year: YEAR_DAYS * slope.per_day,
        low: YEAR_DAYS * slope.low,
        high: YEAR_DAYS * slope.high,
        change: slope.per_day * slope.span_days / slope.level,
        p_value: slope.p_value,
        q_value: 1.0,
    }
}

fn different(
    machine: &str,
    (name, unit): (&str, &str),
    value: Value,
    difference: sisters::Difference,
) -> Different {
    Different {
        machine: machine.to_owned(),
        parameter: name.to_owned(),
        unit: unit.to_owned(),
        value: value.mean,
        std: value.std,
        median: difference.median,
        between_std: difference.between_std,
        z: difference.z,
        p_value: difference.p_value,
        q_value: 1.0,
    }
}
