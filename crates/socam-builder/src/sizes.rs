//! Start values of parameters: given by the user, computed from sizes and masses, or typical.

use crate::words::Size;

/// Trust in a start value, the least first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Trust {
    /// A typical value.
    Usual,
    /// A value from a recording.
    Recorded,
    /// A value computed from masses and sizes.
    Computed,
    /// The user's value.
    Given,
}

/// A parameter as it will be written.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parameter {
    pub(crate) value: f64,
    pub(crate) unit: String,
    /// Value in SI divided by `value`.
    pub(crate) factor: f64,
    /// Bounds in `unit`; `None` for a fixed parameter.
    pub(crate) bounds: Option<[f64; 2]>,
    pub(crate) fixed: bool,
    pub(crate) source: String,
    pub(crate) trust: Trust,
}

impl Parameter {
    fn new(value: f64, unit: &str, ends: [f64; 2], source: impl Into<String>, trust: Trust) -> Self {
        Self {
            value,
            unit: unit.to_owned(),
            factor: 1.0,
            bounds: Some(ends.map(rounded)),
            fixed: false,
            source: source.into(),
            trust,
        }
    }

    /// The value that the user gave. Its bounds are a factor of five away.
    pub(crate) fn given(size: &Size) -> Self {
        let value = size.value;
        let source = format!("given: {value} {}", size.unit);
        let ends = [value / 5.0, value * 5.0];
        let unit = if size.unit.is_empty() { "1" } else { &size.unit };
        Self { factor: size.si / value, ..Self::new(value, unit, ends, source, Trust::Given) }
    }

    /// A value computed from sizes; `source` states the formula in words. The bounds are the value divided by `lower` and
    /// multiplied by `upper`.
    pub(crate) fn computed(value: f64, unit: &str, (lower, upper): (f64, f64), source: String) -> Self {
        let value = rounded(value);
        Self::new(value, unit, [value / lower, value * upper], source, Trust::Computed)
    }

    /// A typical value between `low` and `high`. Its bounds are a factor of ten beyond these.
    pub(crate) fn usual(value: f64, unit: &str, low: f64, high: f64, of: &str) -> Self {
        let source = format!("typical of {of}: {low} to {high} {unit}; write your own value");
        Self::new(value, unit, [low / 10.0, high * 10.0], source, Trust::Usual)
    }

    pub(crate) fn fixed(value: f64, unit: &str, source: impl Into<String>) -> Self {
        Self { fixed: true, bounds: None, ..Self::new(value, unit, [0.0; 2], source, Trust::Given) }
    }

    /// A damping, from 0 up to `most` times its start value.
    pub(crate) fn damping(value: f64, unit: &str, most: f64, source: String) -> Self {
        let value = rounded(value);
        Self::new(value, unit, [0.0, most * value], source, Trust::Usual)
    }

    pub(crate) fn si(&self) -> f64 {
        self.value * self.factor
    }
}

/// Rounds to three significant digits.
pub(crate) fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// A number as a person writes it.
pub(crate) fn written(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e5).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

/// Shear moduli of materials, GPa.
pub(crate) const SHEAR_MODULI: [(&[&str], f64); 5] = [
    (&["steel", "stainless"], 79.0),
    (&["aluminium", "aluminum", "alu"], 26.0),
    (&["titanium"], 43.0),
    (&["brass"], 37.0),
    (&["carbon", "cfrp"], 20.0),
];

/// Torsional stiffness of a round shaft: G pi d^4 / (32 L).
pub(crate) fn shaft(diameter_m: f64, length_m: f64, material: &str, shear_gpa: f64) -> Parameter {
    let stiffness = shear_gpa * 1e9 * std::f64::consts::PI * diameter_m.powi(4) / (32.0 * length_m);
    let source = format!(
        "{material} shaft {} mm x {} mm: G pi d^4/(32 L) with G = {shear_gpa} GPa; its ends make it softer",
        rounded(1e3 * diameter_m),
        rounded(1e3 * length_m)
    );
    Parameter::computed(stiffness, "N m/rad", (30.0, 2.0), source)
}

/// Force per strain and width of a belt, N/m: between glass fibres (about 2 kN/mm) and steel cords (about 17 kN/mm).
pub(crate) const BELT_N_PER_M: f64 = 5e6;

/// Stiffness of both spans of a belt at the driven pulley.
pub(crate) fn belt(width_m: f64, span_m: f64, radius_m: f64, (per_width, given): (f64, bool)) -> Parameter {
    let stiffness = 2.0 * per_width * width_m / span_m * radius_m * radius_m;
    let how = if given { "given" } else { "assumed; 2 with glass fibres to 17 with steel cords" };
    let source = format!(
        "both spans at the driven pulley: 2 (EA/b) b r^2/span with EA/b = {} kN/mm ({how}), b = {} mm, r = {} mm, span = {} mm",
        rounded(1e-6 * per_width),
        rounded(1e3 * width_m),
        rounded(1e3 * radius_m),
        rounded(1e3 * span_m)
    );
    Parameter::computed(stiffness, "N m/rad", (20.0, 10.0), source)
}
