//! The grammar of formulas that are tried in the place of a curve: sums of at most two terms, each an amplitude times factors of one
//! coordinate. Every factor is a number: the coordinate enters only divided by a scale in its own unit, so all sums are dimensionally valid.

/// Shares of the coordinate's largest size at which a scale is tried.
const WIDTHS: &[f64] = &[0.01, 0.03, 0.06, 0.12, 0.25, 0.5, 1.0];
const FALLS: &[f64] = &[0.05, 0.1, 0.2, 0.4, 0.8, 1.6];
const PEAKS: &[f64] = &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
const SPREADS: &[f64] = &[0.05, 0.1, 0.2, 0.4];
const MOMENTS: &[f64] = &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];

/// A factor of a term.
#[derive(Debug)]
pub(super) struct Factor {
    /// How it continues a product: `x` is the coordinate, `r` its largest size, `s` and `t` are the factor's scales.
    text: &'static str,
    /// Its value; the coordinate and the scales are shares of the coordinate's largest size.
    value: fn(f64, &[f64]) -> f64,
    /// Names of its scales, and the shares at which each is tried.
    scales: &'static [(&'static str, &'static [f64])],
}

const fn factor(
    text: &'static str,
    value: fn(f64, &[f64]) -> f64,
    scales: &'static [(&'static str, &'static [f64])],
) -> Factor {
    Factor { text, value, scales }
}

static LINEAR: Factor = factor("*x/r", |x, _| x, &[]);
static SIZE: Factor = factor("*abs(x)/r", |x, _| x.abs(), &[]);
static SIGNED_SQUARE: Factor = factor("*x*abs(x)/r^2", |x, _| x * x.abs(), &[]);
static SQUARE: Factor = factor("*(x/r)^2", |x, _| x * x, &[]);
static CUBE: Factor = factor("*(x/r)^3", |x, _| x * x * x, &[]);
static SATURATING: Factor = factor("*tanh(x/s)", |x, s| (x / s[0]).tanh(), &[("width", WIDTHS)]);
static SINE: Factor = factor("*sin(x/s)", |x, s| (x / s[0]).sin(), &[("length", FALLS)]);
static COSINE: Factor = factor("*cos(x/s)", |x, s| (x / s[0]).cos(), &[("length", FALLS)]);
static GAUSSIAN: Factor = factor("*exp(-(x/s)^2)", |x, s| (-(x / s[0]).powi(2)).exp(), &[("fall", FALLS)]);
static EXPONENTIAL: Factor = factor("*exp(-abs(x)/s)", |x, s| (-x.abs() / s[0]).exp(), &[("fall", FALLS)]);
static DECAY: Factor = factor("*exp(-x/s)", |x, s| (-x / s[0]).exp(), &[("fall", FALLS)]);
static RATIONAL: Factor =
    factor("/(1 + (x/s)^2)", |x, s| 1.0 / (1.0 + (x / s[0]).powi(2)), &[("fall", FALLS)]);
static HUMP: Factor = factor(
    "*exp(-((abs(x) - s)/t)^2)",
    |x, s| (-((x.abs() - s[0]) / s[1]).powi(2)).exp(),
    &[("peak", PEAKS), ("spread", SPREADS)],
);
static STEP: Factor = factor(
    "*(0.5 + 0.5*tanh((x - s)/t))",
    |x, s| 0.5 + 0.5 * ((x - s[0]) / s[1]).tanh(),
    &[("moment", MOMENTS), ("width", SPREADS)],
);

/// A term: the product of an amplitude and of these factors.
#[derive(Debug, Clone)]
pub(super) struct Term(Vec<&'static Factor>);

/// All terms over a place's own coordinate: a power, a saturation or a wave, and how it falls.
pub(super) fn over_a_coordinate() -> Vec<Term> {
    let falls = [None, Some(&GAUSSIAN), Some(&EXPONENTIAL), Some(&RATIONAL)];
    let begun: [&[&'static Factor]; 9] = [
        &[],
        &[&LINEAR],
        &[&SIZE],
        &[&SIGNED_SQUARE],
        &[&SQUARE],
        &[&CUBE],
        &[&SATURATING],
        &[&SATURATING, &SIZE],
        &[&SATURATING, &SQUARE],
    ];
    let waves_and_humps: [&[&'static Factor]; 5] =
        [&[&SINE], &[&COSINE], &[&HUMP], &[&LINEAR, &HUMP], &[&SATURATING, &HUMP]];
    products(&begun, &falls).chain(products(&waves_and_humps, &[None])).collect()
}

/// All terms over time, from the start of a recording.
pub(super) fn over_time() -> Vec<Term> {
    let begun: [&[&'static Factor]; 5] = [&[], &[&LINEAR], &[&SQUARE], &[&SINE], &[&COSINE]];
    products(&begun, &[None, Some(&DECAY)]).chain([Term(vec![&STEP])]).collect()
}

fn products<'a>(
    begun: &'a [&'a [&'static Factor]],
    falls: &'a [Option<&'static Factor>],
) -> impl Iterator<Item = Term> + 'a {
    let each = begun.iter().flat_map(move |begun| falls.iter().map(move |fall| (begun, fall)));
    each.map(|(begun, fall)| Term(begun.iter().copied().chain(*fall).collect()))
}

/// A scale of a formula: its name, and the shares at which it is tried.
type Scale = (String, &'static [f64]);

impl Term {
    /// Its scales; the names end in `suffix`.
    pub(super) fn scales(&self, suffix: &str) -> Vec<Scale> {
        let each = self.0.iter().flat_map(|factor| factor.scales);
        each.map(|(name, shares)| (format!("{name}{suffix}"), *shares)).collect()
    }

    /// Value with an amplitude of 1, at a share `x` of the coordinate's largest size.
    pub(super) fn value(&self, x: f64, mut scales: &[f64]) -> f64 {
        let each = self.0.iter().map(|factor| {
            let (own, others) = scales.split_at(factor.scales.len());
            scales = others;
            (factor.value)(x, own)
        });
        each.product()
    }

    /// The term as a formula over `x`. Names of its amplitude, of `x`'s largest size and of its scales end in what tells terms apart.
    pub(super) fn text(&self, amplitude: &str, x: &str, suffix: &str) -> String {
        let mut text = amplitude.to_owned();
        for factor in &self.0 {
            let mut names = factor.scales.iter().map(|(name, _)| format!("{name}{suffix}"));
            let (s, t) = (names.next().unwrap_or_default(), names.next().unwrap_or_default());
            let mut before = ' ';
            for (at, letter) in factor.text.char_indices() {
                let after = factor.text[at + 1..].chars().next().unwrap_or(' ');
                let is_alone = !before.is_ascii_alphabetic() && !after.is_ascii_alphabetic();
                match letter {
                    'x' if is_alone => text.push_str(x),
                    'r' if is_alone => text.push_str(REFERENCE),
                    's' if is_alone => text.push_str(&s),
                    't' if is_alone => text.push_str(&t),
                    _ => text.push(letter),
                }
                before = letter;
            }
        }
        text
    }

    /// Whether its formula names the coordinate's largest size.
    pub(super) fn names_reference(&self) -> bool {
        self.0.iter().any(|factor| factor.text.contains("/r"))
    }
}

/// Name of the coordinate's largest size, which is fixed.
pub(super) const REFERENCE: &str = "reference";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_term_is_written_in_its_own_names() {
        let texts: Vec<String> =
            over_a_coordinate().iter().map(|term| term.text("a", "speed", "_2")).collect();
        for text in [
            "a",
            "a*x/r",
            "a*x/r/(1 + (x/fall)^2)",
            "a*tanh(x/width)*abs(x)/r*exp(-abs(x)/fall)",
            "a*tanh(x/width)*exp(-((abs(x) - peak)/spread)^2)",
        ] {
            let names = ["width", "fall", "peak", "spread"];
            let text = text.replace("abs(x)", "abs(speed)").replace("(x", "(speed").replace("*x", "*speed");
            let text = text.replace("/r", "/reference");
            let text = names.iter().fold(text, |text, name| text.replace(name, &format!("{name}_2")));
            assert!(texts.contains(&text), "{text} is not among {texts:?}");
        }
    }
}
