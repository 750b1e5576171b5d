//! Number, mean and sum of squared deviations of values, which join exactly and without cancellation.

/// Values that are finite.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Moments {
    pub(crate) count: f64,
    pub(crate) mean: f64,
    /// Sum of squared differences from the mean.
    pub(crate) squares: f64,
}

impl Moments {
    /// Moments of stored values; missing values (NaN) are ignored.
    pub(crate) fn of(values: &[f32]) -> Self {
        let finite = || values.iter().filter(|value| value.is_finite()).map(|value| f64::from(*value));
        let (count, sum) = finite().fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
        if count == 0.0 {
            return Self::default();
        }
        let mean = sum / count;
        Self { count, mean, squares: finite().map(|value| (value - mean).powi(2)).sum() }
    }

    /// Moments of both sets together (Chan, Golub and LeVeque, The American Statistician 37, 1983).
    pub(crate) fn join(self, other: Self) -> Self {
        let count = self.count + other.count;
        if count == 0.0 {
            return self;
        }
        let (apart, share) = (other.mean - self.mean, other.count / count);
        Self {
            count,
            mean: self.mean + share * apart,
            squares: self.squares + other.squares + apart * apart * self.count * share,
        }
    }
}
