//! Every formula of the grammar on the points of a curve: linear least squares for the amplitudes, at every scale of a grid.

use std::collections::HashMap;

use super::grammar::Term;

/// Error of a curve's points beside their standard errors, as a share of the largest: raised cosines follow a bent law only so closely.
const CURVE_ERROR: f64 = 0.02;
/// Largest number of amplitudes and scales of a formula: a curve has nine points or a few more.
const MOST_PARAMETERS: usize = 5;
/// Number of formulas with one term, and of sums, whose scales leave the grid.
const REFINED: usize = 20;
/// Numbers of formulas with one term, and of sums, that are fitted to the recordings: a curve's points tell simple ones apart least.
const FITTED: [usize; 2] = [5, 2];
/// Largest size of a term, in units of the largest height: larger ones cancel each other and mean nothing each.
const LARGEST_TERM: f64 = 3.0;
/// Least and largest scale, as shares of the coordinate's largest size: what is smaller or larger was not seen.
pub(super) const SCALES: [f64; 2] = [1e-3, 10.0];
/// First and last steps of the search for scales, as shares of them.
const FIRST_STEP: f64 = 0.5;
const LAST_STEP: f64 = 5e-3;
/// Least share of a column that other free parameters of the model leave.
const LEAST_LEFT: f64 = 1e-3;

/// The points of a curve.
pub(super) struct Points {
    /// Coordinate, as a share of its largest size.
    pub(super) x: Vec<f64>,
    /// Height.
    pub(super) height: Vec<f64>,
    /// Standard error of the height.
    pub(super) std: Vec<f64>,
    /// Whether a free parameter of the model is a torque proportional to the coordinate, so that the curve may hold some of it too.
    pub(super) is_free_of_slope: bool,
}

/// A formula with the amplitudes and scales that follow the points best.
#[derive(Debug, Clone)]
pub(super) struct Form {
    pub(super) terms: Vec<FittedTerm>,
    /// What the free parameter beside it takes of the points, per largest size of the coordinate.
    pub(super) slope: f64,
    /// Sum of squares over the points, in their errors, and the price of the parameters (Bayesian information criterion).
    cost: f64,
}

#[derive(Debug, Clone)]
pub(super) struct FittedTerm {
    pub(super) term: Term,
    pub(super) amplitude: f64,
    /// Shares of the coordinate's largest size.
    pub(super) scales: Vec<f64>,
}

impl Form {
    /// Number of amplitudes and scales.
    pub(super) fn parameters(&self) -> usize {
        self.terms.iter().map(|term| 1 + term.scales.len()).sum()
    }
}

/// A term at one set of scales: its weighted values, without their part along a free slope.
struct Column<'t> {
    term: usize,
    scales: Vec<f64>,
    values: Vec<f64>,
    square: f64,
    along: f64,
    /// Its largest value.
    largest: f64,
    of: &'t Term,
}

/// The formulas that follow the points best: some with one term, some with two, the likeliest first.
pub(super) fn likeliest(points: &Points, terms: &[Term]) -> Vec<Form> {
    let weighted = Weighted::new(points);
    let columns: Vec<Column<'_>> =
        terms.iter().enumerate().flat_map(|(index, term)| weighted.columns(index, term)).collect();
    let mut best = Best::default();
    for (at, first) in columns.iter().enumerate() {
        best.take(&weighted, &[(first, first.along / first.square)]);
        for second in &columns[at + 1..] {
            if let Some(both) = solved(first, second) {
                best.take(&weighted, &[(first, both[0]), (second, both[1])]);
            }
        }
    }
    best.likeliest(&weighted)
}

/// Amplitudes of two columns; `None` where they are too alike to be told apart.
fn solved(first: &Column<'_>, second: &Column<'_>) -> Option<[f64; 2]> {
    let cross = dot(&first.values, &second.values);
    let determinant = first.square * second.square - cross * cross;
    (determinant > LEAST_LEFT * first.square * second.square).then(|| {
        [
            (second.square * first.along - cross * second.along) / determinant,
            (first.square * second.along - cross * first.along) / determinant,
        ]
    })
}

/// The points with each divided by its error, and what is free beside them.
struct Weighted<'p> {
    points: &'p Points,
    weights: Vec<f64>,
    slope: Option<Vec<f64>>,
    heights: Vec<f64>,
    /// Sum of their squares.
    square: f64,
    /// The largest height.
    largest: f64,
}

impl<'p> Weighted<'p> {
    fn new(points: &'p Points) -> Self {
        let largest = points.height.iter().fold(0.0_f64, |most, height| most.max(height.abs()));
        let weights: Vec<f64> = points
            .std
            .iter()
            .map(|std| 1.0 / std.hypot(CURVE_ERROR * largest).max(f64::MIN_POSITIVE))
            .collect();
        let slope = points.is_free_of_slope.then(|| {
            let slope: Vec<f64> = points.x.iter().zip(&weights).map(|(x, weight)| x * weight).collect();
            let norm = dot(&slope, &slope).sqrt();
            slope.iter().map(|value| value / norm).collect()
        });
        let mut weighted = Self { points, weights, slope, heights: Vec::new(), square: 0.0, largest };
        weighted.heights = weighted.without_slope(points.height.iter().copied());
        weighted.square = dot(&weighted.heights, &weighted.heights);
        weighted
    }

    fn without_slope(&self, values: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut values: Vec<f64> = values.zip(&self.weights).map(|(value, weight)| value * weight).collect();
        if let Some(slope) = &self.slope {
            let along = dot(&values, slope);
            values.iter_mut().zip(slope).for_each(|(value, slope)| *value -= along * slope);
        }
        values
    }

    /// A term at each point of the grid of its scales.
    fn columns<'t>(&self, index: usize, term: &'t Term) -> Vec<Column<'t>> {
        let mut all: Vec<Vec<f64>> = vec![Vec::new()];
        for (_, shares) in term.scales("") {
            let grown =
                |own: &Vec<f64>| shares.iter().map(|share| [own, &[*share][..]].concat()).collect::<Vec<_>>();
            all = all.iter().flat_map(grown).collect();
        }
        all.into_iter().filter_map(|scales| self.column(index, term, scales)).collect()
    }

    /// `None` where what is free beside the term makes nearly the same.
    fn column<'t>(&self, index: usize, term: &'t Term, scales: Vec<f64>) -> Option<Column<'t>> {
        let whole: Vec<f64> = self.points.x.iter().map(|x| term.value(*x, &scales)).collect();
        let largest = whole.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let weighted: f64 =
            whole.iter().zip(&self.weights).map(|(value, weight)| (value * weight).powi(2)).sum();
        let values = self.without_slope(whole.into_iter());
        let (square, along) = (dot(&values, &values), dot(&values, &self.heights));
        let column = Column { term: index, scales, values, square, along, largest, of: term };
        (square > LEAST_LEFT * weighted).then_some(column)
    }

    /// A formula whose scales leave the grid: a pattern search over their logarithms.
    fn refined(&self, mut form: Form) -> Form {
        let mut step = FIRST_STEP;
        while step > LAST_STEP {
            let before = form.cost;
            let scales = form
                .terms
                .iter()
                .enumerate()
                .flat_map(|(term, own)| (0..own.scales.len()).map(move |scale| (term, scale)));
            for (term, scale) in scales.collect::<Vec<_>>() {
                for factor in [1.0 + step, 1.0 / (1.0 + step)] {
                    let mut moved = form.clone();
                    moved.terms[term].scales[scale] *= factor;
                    form = self.solved(moved).filter(|moved| moved.cost < form.cost).unwrap_or(form);
                }
            }
            if form.cost >= before {
                step *= 0.5;
            }
        }
        form.slope = self.slope_beside(&form);
        form
    }

    /// A formula at its scales, with the amplitudes that follow the points best.
    fn solved(&self, mut form: Form) -> Option<Form> {
        let [least, most] = SCALES;
        if form.terms.iter().flat_map(|own| &own.scales).any(|scale| *scale < least || *scale > most) {
            return None;
        }
        let columns = form.terms.iter().map(|own| self.column(0, &own.term, own.scales.clone()));
        let columns: Vec<Column<'_>> = columns.collect::<Option<_>>()?;
        let amplitudes = match columns.as_slice() {
            [one] => vec![one.along / one.square],
            [first, second] => solved(first, second)?.to_vec(),
            _ => return None,
        };
        let cost = self.cost(&columns.iter().zip(amplitudes.iter().copied()).collect::<Vec<_>>())?;
        drop(columns);
        form.terms.iter_mut().zip(amplitudes).for_each(|(own, amplitude)| own.amplitude = amplitude);
        Some(Form { cost, ..form })
    }

    /// `None` for more parameters than the points determine, and for terms that mostly cancel each other.
    fn cost(&self, columns: &[(&Column<'_>, f64)]) -> Option<f64> {
        let parameters: usize = columns.iter().map(|(column, _)| 1 + column.scales.len()).sum();
        let cancels = |(column, amplitude): &(&Column<'_>, f64)| {
            amplitude.abs() * column.largest > LARGEST_TERM * self.largest
        };
        if parameters > MOST_PARAMETERS || parameters >= self.points.x.len() || columns.iter().any(cancels) {
            return None;
        }
        let explained: f64 = columns.iter().map(|(column, amplitude)| amplitude * column.along).sum();
        let price = parameters as f64 * (self.points.x.len() as f64).ln();
        Some((self.square - explained).max(0.0) + price)
    }

    fn slope_beside(&self, form: &Form) -> f64 {
        let Some(slope) = &self.slope else { return 0.0 };
        let left =
            self.points.x.iter().zip(&self.points.height).zip(&self.weights).map(|((x, height), weight)| {
                let of_terms: f64 =
                    form.terms.iter().map(|own| own.amplitude * own.term.value(*x, &own.scales)).sum();
                weight * (height - of_terms)
            });
        let steepness: f64 =
            self.points.x.iter().zip(&self.weights).map(|(x, weight)| (x * weight).powi(2)).sum();
        left.zip(slope).map(|(left, slope)| left * slope).sum::<f64>() / steepness.sqrt()
    }
}

/// The best fit of each formula, by the numbers of its terms.
#[derive(Default)]
struct Best(HashMap<(usize, Option<usize>), Form>);

impl Best {
    fn take(&mut self, points: &Weighted<'_>, columns: &[(&Column<'_>, f64)]) {
        let [(first, _), ..] = columns else { return };
        let Some(cost) = points.cost(columns) else { return };
        let terms = (first.term, columns.get(1).map(|(column, _)| column.term));
        if self.0.get(&terms).is_none_or(|known| cost < known.cost) {
            let fitted = |(column, amplitude): &(&Column<'_>, f64)| FittedTerm {
                term: column.of.clone(),
                amplitude: *amplitude,
                scales: column.scales.clone(),
            };
            self.0.insert(terms, Form { terms: columns.iter().map(fitted).collect(), slope: 0.0, cost });
        }
    }

    /// The best of one term and of two, chosen again after their scales have left the grid.
    fn likeliest(self, points: &Weighted<'_>) -> Vec<Form> {
        let mut all: Vec<((usize, Option<usize>), Form)> = self.0.into_iter().collect();
        all.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost).then(a.0.cmp(&b.0)));
        let of = |is_sum: bool, count: usize| {
            let best = all.iter().filter(|(terms, _)| terms.1.is_some() == is_sum).take(REFINED);
            let mut refined: Vec<Form> = best.map(|(_, form)| points.refined(form.clone())).collect();
            refined.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            refined.truncate(count);
            refined
        };
        let [single, sums] = FITTED;
        [of(false, single), of(true, sums)].concat()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::{
        super::grammar::{over_a_coordinate, over_time},
        *,
    };

    /// Points as a curve has them, of a law over shares of the coordinate.
    fn points(law: impl Fn(f64) -> f64, is_free_of_slope: bool) -> Points {
        let x: Vec<f64> = (-6..=6).map(|k| f64::from(k) / 6.0).collect();
        let height: Vec<f64> = x.iter().map(|x| law(*x)).collect();
        Points { std: vec![1e-3; x.len()], x, height, is_free_of_slope }
    }

    fn first(points: &Points, terms: usize) -> String {
        let all = likeliest(points, &over_a_coordinate());
        let found = all.into_iter().find(|form| form.terms.len() == terms).unwrap();
        let each = found.terms.iter().map(|one| one.term.text("a", "x", ""));
        each.collect::<Vec<_>>().join(" + ")
    }

    #[test]
    fn the_law_that_made_the_points_comes_first() {
        assert_eq!(
            first(&points(|x| 0.8 * x / (1.0 + (x / 0.25).powi(2)), false), 1),
            "a*x/reference/(1 + (x/fall)^2)"
        );
        assert_eq!(first(&points(|x| -2.0 * x * x * x, false), 1), "a*(x/reference)^3");
        let both = points(|x| 0.5 * x * x.abs() + 0.3 * (x / 0.4).cos(), false);
        assert_eq!(first(&both, 2), "a*x*abs(x)/reference^2 + a*cos(x/length)");
    }

    /// The model's own damping takes what is proportional to the speed.
    #[test]
    fn a_free_slope_is_no_part_of_the_law() {
        let with_slope = points(|x| 3.0 * x + 0.7 * (x / 0.12).tanh(), true);
        assert_eq!(first(&with_slope, 1), "a*tanh(x/width)");
    }

    #[test]
    fn a_step_in_time_is_found_where_it_is() {
        let x: Vec<f64> = (0..9).map(|k| f64::from(k) / 8.0).collect();
        let height = x.iter().map(|x| 0.5 + 0.5 * ((x - 0.6) / 0.1).tanh()).collect();
        let points = Points { std: vec![0.01; 9], x, height, is_free_of_slope: false };
        let found = &likeliest(&points, &over_time())[0];
        assert_eq!(found.terms[0].scales, [0.6, 0.1]);
        assert!((found.terms[0].amplitude - 1.0).abs() < 0.01);
    }
}
