//! Curves through points: a cubic between neighbours with continuous slope, linear in the values at the points.
//!
//! The slope at a point is that of the parabola through it and its two neighbours, at an end that of the line to its neighbour. Beyond an
//! end the curve continues with the end's slope.

/// A curve of a law: the positions of its points, and their values.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Curve {
    /// Index of the law's input over which it is drawn.
    pub(crate) input: usize,
    /// Positions, increasing; at least two.
    pub(crate) at: Vec<f64>,
    pub(crate) values: Values,
}

/// Values at the points of a curve.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Values {
    Numbers(Vec<f64>),
    /// Indices of parameters of the law.
    Parameters(Vec<usize>),
}

/// Weights of the values of four neighbouring points, the first of which is the point `first`; those beyond an end are zero.
struct Weights {
    first: usize,
    value: [f64; 4],
    slope: [f64; 4],
}

impl Curve {
    /// The curve at `x`, and its slope.
    pub(super) fn evaluate(&self, x: f64, parameters: &[f64]) -> (f64, f64) {
        let weights = self.weights(x);
        let (mut value, mut slope) = (0.0, 0.0);
        for k in 0..4 {
            if let Some(own) = self.value(weights.first + k, parameters) {
                value += weights.value[k] * own;
                slope += weights.slope[k] * own;
            }
        }
        (value, slope)
    }

    /// Adds `factor` times the derivative by each parameter at `x`.
    pub(super) fn add_derivatives(&self, x: f64, factor: f64, by_parameter: &mut [f64]) {
        let Values::Parameters(indices) = &self.values else { return };
        let weights = self.weights(x);
        for (weight, index) in weights.value.iter().zip(&indices[weights.first..]) {
            by_parameter[*index] += factor * weight;
        }
    }

    /// Whether the curve is zero where the parameters for which `is_zero` holds are.
    pub(super) fn vanishes(&self, is_zero: impl Fn(usize) -> bool) -> bool {
        match &self.values {
            Values::Numbers(numbers) => numbers.iter().all(|number| *number == 0.0),
            Values::Parameters(indices) => indices.iter().all(|index| is_zero(*index)),
        }
    }

    /// Whether a value is one of the parameters for which `is_one` holds.
    pub(super) fn depends_on(&self, is_one: impl Fn(usize) -> bool) -> bool {
        matches!(&self.values, Values::Parameters(indices) if indices.iter().any(|index| is_one(*index)))
    }

    fn value(&self, point: usize, parameters: &[f64]) -> Option<f64> {
        match &self.values {
            Values::Numbers(numbers) => numbers.get(point).copied(),
            Values::Parameters(indices) => indices.get(point).map(|index| parameters[*index]),
        }
    }

    /// Weights of the values in the slope at a point, for the point before it, itself and the next.
    fn slope_at(&self, point: usize) -> [f64; 3] {
        let width = |from: usize| self.at[from + 1] - self.at[from];
        if point == 0 {
            return [0.0, -1.0 / width(0), 1.0 / width(0)];
        }
        if point == self.at.len() - 1 {
            return [-1.0 / width(point - 1), 1.0 / width(point - 1), 0.0];
        }
        let (before, after) = (width(point - 1), width(point));
        let both = before + after;
        [-after / (before * both), (after - before) / (before * after), before / (after * both)]
    }

    fn weights(&self, x: f64) -> Weights {
        let last = self.at.len() - 1;
        let point = self.at.partition_point(|at| *at <= x).saturating_sub(1).min(last - 1);
        let (start, width) = (self.at[point], self.at[point + 1] - self.at[point]);
        let t = (x - start) / width;
        // Values and slopes of the four cubics: value and slope at the two ends.
        let (value, slope) = if t < 0.0 {
            ([1.0, t * width, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0])
        } else if t > 1.0 {
            ([0.0, 0.0, 1.0, (t - 1.0) * width], [0.0, 0.0, 0.0, 1.0])
        } else {
            let rest = 1.0 - t;
            let rise = 6.0 * t * rest / width;
            (
                [
                    (1.0 + 2.0 * t) * rest * rest,
                    t * rest * rest * width,
                    t * t * (3.0 - 2.0 * t),
                    -t * t * rest * width,
                ],
                [-rise, rest * (1.0 - 3.0 * t), rise, t * (3.0 * t - 2.0)],
            )
        };
        // The points are those of the interval and one on either side; at the first interval the list is shifted by one.
        let first = point.saturating_sub(1);
        let own = point - first;
        let mut found = Weights { first, value: [0.0; 4], slope: [0.0; 4] };
        for (end, k) in [(point, 0), (point + 1, 2)] {
            let at = own + end - point;
            found.value[at] += value[k];
            found.slope[at] += slope[k];
            for (index, weight) in self.slope_at(end).into_iter().enumerate() {
                // The slope's three points are those about `end`; a weight beyond an end of the curve is zero.
                if let Some(position) = (at + index).checked_sub(1).filter(|position| *position < 4) {
                    found.value[position] += weight * value[k + 1];
                    found.slope[position] += weight * slope[k + 1];
                }
            }
        }
        found
    }

    /// The curve over the input `x` as a formula with `min` and `max`; parameters by their names.
    pub(crate) fn formula(&self, x: &str, names: &[&str]) -> String {
        let last = self.at.len() - 1;
        let [first_slope, last_slope] =
            [0, last].map(|end| self.combination(&self.slope_weights(end), names));
        let mut text = format!(
            "{} + {first_slope}*min({x} - {}, 0) + {last_slope}*max({x} - {}, 0)",
            self.combination(&[(0, 1.0)], names),
            number(self.at[0]),
            number(self.at[last])
        );
        for point in 0..last {
            let width = self.at[point + 1] - self.at[point];
            let within = format!(
                "(min(max({x}, {}), {}) - {})",
                number(self.at[point]),
                number(self.at[point + 1]),
                number(self.at[point])
            );
            // s0 u + (3 d/w - 2 s0 - s1)/w u^2 + (s0 + s1 - 2 d/w)/w^2 u^3 with the rise d, the width w and the slopes s0 and s1.
            let rise = [(point, -1.0 / width), (point + 1, 1.0 / width)];
            let [own, next] = [point, point + 1].map(|end| self.slope_weights(end));
            let sum = |parts: [(&[(usize, f64)], f64); 3], by: f64| {
                let each = parts
                    .iter()
                    .flat_map(|(part, factor)| part.iter().map(move |(k, w)| (*k, w * factor / by)));
                self.combination(&each.collect::<Vec<_>>(), names)
            };
            let square = sum([(&rise, 3.0), (&own, -2.0), (&next, -1.0)], width);
            let cube = sum([(&rise, -2.0), (&own, 1.0), (&next, 1.0)], width * width);
            text += &format!(
                " + {within}*({} + {within}*({square} + {within}*{cube}))",
                self.combination(&own, names)
            );
        }
        text
    }

    fn slope_weights(&self, point: usize) -> Vec<(usize, f64)> {
        let all = self.slope_at(point).into_iter().enumerate().filter(|(_, weight)| *weight != 0.0);
        all.map(|(index, weight)| (point + index - 1, weight)).collect()
    }

    /// A sum of weighted values, in brackets.
    fn combination(&self, weights: &[(usize, f64)], names: &[&str]) -> String {
        match &self.values {
            Values::Numbers(numbers) => number(weights.iter().map(|(k, weight)| weight * numbers[*k]).sum()),
            Values::Parameters(indices) => {
                let mut sums: Vec<(usize, f64)> = Vec::new();
                for (k, weight) in weights {
                    match sums.iter_mut().find(|(known, _)| known == k) {
                        Some((_, sum)) => *sum += weight,
                        None => sums.push((*k, *weight)),
                    }
                }
                let each = sums.iter().map(|(k, sum)| format!("{}*{}", number(*sum), names[indices[*k]]));
                format!("({})", each.collect::<Vec<_>>().join(" + "))
            }
        }
    }
}

/// A number that may stand anywhere in a formula.
fn number(value: f64) -> String {
    if value < 0.0 { format!("({value:?})") } else { format!("{value:?}") }
}
