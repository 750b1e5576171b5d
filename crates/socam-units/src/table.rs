//! The table of units.

use std::f64::consts::{PI, TAU};

use crate::Product;

/// Sets of names that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Words {
    /// Names of model files, which docs/model-file.md lists.
    ModelFile,
    /// Also names of other programs.
    All,
}

/// A unit: its SI value is `factor * value + offset`.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) name: &'static str,
    pub(crate) factor: f64,
    pub(crate) offset: f64,
    pub(crate) product: Product,
    pub(crate) words: Words,
}

const fn own(name: &'static str, factor: f64, product: Product) -> Row {
    Row { name, factor, offset: 0.0, product, words: Words::ModelFile }
}

const fn other(name: &'static str, factor: f64, product: Product) -> Row {
    Row { words: Words::All, ..own(name, factor, product) }
}

const ONE: Product = Product::ONE;
const SECOND: Product = Product::SECOND;
const NEWTON: Product = Product([1, 0, 0, 0, 0, 0, 0]);
const VOLT: Product = Product([0, 1, 0, 0, 0, 0, 0]);
const AMPERE: Product = Product([0, 0, 1, 0, 0, 0, 0]);
const KELVIN: Product = Product([0, 0, 0, 1, 0, 0, 0]);
const METRE: Product = Product([0, 0, 0, 0, 1, 0, 0]);
const RADIAN: Product = Product([0, 0, 0, 0, 0, 1, 0]);
const MASS: Product = Product([1, 0, 0, 0, -1, 0, 2]);
const HERTZ: Product = Product([0, 0, 0, 0, 0, 0, -1]);
const SPEED: Product = Product([0, 0, 0, 0, 0, 1, -1]);
const OHM: Product = Product([0, 1, -1, 0, 0, 0, 0]);
const HENRY: Product = Product([0, 1, -1, 0, 0, 0, 1]);

const DEGREE: f64 = PI / 180.0;
const POUND_FORCE_N: f64 = 4.448_221_615_260_5;

/// Every unit, once for each of its names.
pub(crate) const UNITS: &[Row] = &[
    own("1", 1.0, ONE),
    own("%", 1e-2, ONE),
    own("kg", 1.0, MASS),
    own("g", 1e-3, MASS),
    own("m", 1.0, METRE),
    own("cm", 1e-2, METRE),
    own("mm", 1e-3, METRE),
    own("um", 1e-6, METRE),
    other("km", 1e3, METRE),
    other("metre", 1.0, METRE),
    other("metres", 1.0, METRE),
    other("meter", 1.0, METRE),
    other("meters", 1.0, METRE),
    other("in", 0.0254, METRE),
    other("inch", 0.0254, METRE),
    other("inches", 0.0254, METRE),
    other("feet", 0.3048, METRE),
    other("ft", 0.3048, METRE),
    own("s", 1.0, SECOND),
    own("ms", 1e-3, SECOND),
    own("us", 1e-6, SECOND),
    own("min", 60.0, SECOND),
    other("ns", 1e-9, SECOND),
    other("h", 3600.0, SECOND),
    other("sec", 1.0, SECOND),
    other("secs", 1.0, SECOND),
    other("second", 1.0, SECOND),
    other("seconds", 1.0, SECOND),
    other("msec", 1e-3, SECOND),
    other("millisecond", 1e-3, SECOND),
    other("milliseconds", 1e-3, SECOND),
    other("usec", 1e-6, SECOND),
    other("microseconds", 1e-6, SECOND),
    own("Hz", 1.0, HERTZ),
    own("kHz", 1e3, HERTZ),
    own("rad", 1.0, RADIAN),
    own("mrad", 1e-3, RADIAN),
    other("urad", 1e-6, RADIAN),
    own("deg", DEGREE, RADIAN),
    other("radian", 1.0, RADIAN),
    other("radians", 1.0, RADIAN),
    other("degree", DEGREE, RADIAN),
    other("degrees", DEGREE, RADIAN),
    other("arcmin", DEGREE / 60.0, RADIAN),
    other("arcsec", DEGREE / 3600.0, RADIAN),
    other("gon", PI / 200.0, RADIAN),
    own("turn", TAU, RADIAN),
    own("rev", TAU, RADIAN),
    other("rotation", TAU, RADIAN),
    other("rotations", TAU, RADIAN),
    other("revolution", TAU, RADIAN),
    other("revolutions", TAU, RADIAN),
    other("turns", TAU, RADIAN),
    other("rot", TAU, RADIAN),
    other("U", TAU, RADIAN),
    own("rpm", TAU / 60.0, SPEED),
    own("krpm", TAU / 0.06, SPEED),
    other("RPM", TAU / 60.0, SPEED),
    own("N", 1.0, NEWTON),
    own("kN", 1e3, NEWTON),
    own("mN", 1e-3, NEWTON),
    other("cN", 1e-2, NEWTON),
    other("uN", 1e-6, NEWTON),
    other("newton", 1.0, NEWTON),
    other("newtons", 1.0, NEWTON),
    other("lbf", POUND_FORCE_N, NEWTON),
    other("ozf", POUND_FORCE_N / 16.0, NEWTON),
    other("kgf", 9.806_65, NEWTON),
    own("A", 1.0, AMPERE),
    own("mA", 1e-3, AMPERE),
    other("uA", 1e-6, AMPERE),
    other("amp", 1.0, AMPERE),
    other("amps", 1.0, AMPERE),
    other("ampere", 1.0, AMPERE),
    other("amperes", 1.0, AMPERE),
    own("V", 1.0, VOLT),
    own("mV", 1e-3, VOLT),
    other("kV", 1e3, VOLT),
    other("volt", 1.0, VOLT),
    other("volts", 1.0, VOLT),
    own("ohm", 1.0, OHM),
    own("mohm", 1e-3, OHM),
    own("H", 1.0, HENRY),
    own("mH", 1e-3, HENRY),
    own("uH", 1e-6, HENRY),
    own("K", 1.0, KELVIN),
    Row { offset: 273.15, ..other("degC", 1.0, KELVIN) },
    Row { offset: 459.67 * 5.0 / 9.0, ..other("degF", 5.0 / 9.0, KELVIN) },
    other("W", 1.0, Product::WATT),
    other("J", 1.0, Product::JOULE),
];

/// Products that are usually written without a blank, and their factors. They are listed because a general rule is ambiguous: `mNm` can be
/// split into factors in several ways.
const RUN_TOGETHER: &[(&str, &str, Words)] = &[
    ("Nm", "N m", Words::ModelFile),
    ("kNm", "kN m", Words::ModelFile),
    ("mNm", "mN m", Words::ModelFile),
    ("Nmm", "N mm", Words::ModelFile),
    ("Ncm", "N cm", Words::ModelFile),
    ("Nms", "N m s", Words::ModelFile),
    ("Nms2", "N m s2", Words::ModelFile),
    ("Ns", "N s", Words::ModelFile),
    ("Ns2", "N s2", Words::ModelFile),
    ("Vs", "V s", Words::ModelFile),
    ("kgm2", "kg m2", Words::ModelFile),
    ("kgcm2", "kg cm2", Words::ModelFile),
    ("kgmm2", "kg mm2", Words::ModelFile),
    ("gm2", "g m2", Words::ModelFile),
    ("gcm2", "g cm2", Words::ModelFile),
    ("gmm2", "g mm2", Words::ModelFile),
    ("uNm", "uN m", Words::All),
    ("cNm", "cN m", Words::All),
    ("NM", "N m", Words::All),
];

impl Words {
    fn holds(self, other: Self) -> bool {
        self == Self::All || other == Self::ModelFile
    }

    /// The unit with this name.
    pub(crate) fn row(self, name: &str) -> Option<&'static Row> {
        UNITS.iter().find(|row| row.name == name && self.holds(row.words))
    }

    /// The factors, with blanks between them, of a product that is written without a blank.
    pub(crate) fn apart(self, together: &str) -> Option<&'static str> {
        let found = RUN_TOGETHER.iter().find(|(name, _, words)| *name == together && self.holds(*words))?;
        Some(found.1)
    }
}

/// The names that [`parse`](crate::parse) reads, for a test of the document that lists them.
pub fn model_file_names() -> impl Iterator<Item = &'static str> {
    let rows = UNITS.iter().filter(|row| row.words == Words::ModelFile).map(|row| row.name);
    let products = RUN_TOGETHER.iter().filter(|(.., words)| *words == Words::ModelFile);
    rows.chain(products.map(|(name, ..)| *name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_has_one_meaning() {
        let names: Vec<&str> =
            UNITS.iter().map(|row| row.name).chain(RUN_TOGETHER.iter().map(|(name, ..)| *name)).collect();
        for (index, name) in names.iter().enumerate() {
            assert!(!names[..index].contains(name), "{name} stands in the table twice");
        }
    }
}
