//! Conversion of a channel's unit, scale and counts to a factor and an offset.

use socam_recording::{Fields, Unit};

/// Unit of the channel, SI value of one and of zero.
pub(super) fn conversion(
    name: &str,
    fields: &mut Fields<'_>,
    text: &str,
    (scale, offset, to): (Option<f64>, Option<f64>, Option<&str>),
    (per_turn, per_metre): (Option<f64>, Option<f64>),
) -> (Unit, f64, f64) {
    let refused = (Unit::One, 1.0, 0.0);
    if socam_units::is_counts(text) {
        return match (per_turn, per_metre) {
            (Some(counts), None) => (Unit::Rad, std::f64::consts::TAU / counts, offset.unwrap_or(0.0)),
            (None, Some(counts)) => (Unit::M, 1.0 / counts, offset.unwrap_or(0.0)),
            _ => {
                let message = format!("`{name}` is in counts; say `counts_per_turn` or `counts_per_m`");
                fields.complain_about("unit", message);
                refused
            }
        };
    }
    if let Some(key) = per_turn.map(|_| "counts_per_turn").or(per_metre.map(|_| "counts_per_m")) {
        fields.complain_about(key, format!("`{key}` is for a signal whose `unit` is \"counts\""));
    }
    if text.is_empty() {
        // A unit that is left out is reported as missing.
        return refused;
    }
    let Some(from) = socam_units::conversion(text) else {
        let message = if text.trim() == "?" {
            format!(
                "`unit` of `{name}` is not known yet; write the unit of the numbers in the file, such as \"rpm\" or \"N m\""
            )
        } else {
            format!(
                "`unit` of `{name}` is \"{text}\", which is no unit known here; write one such as rpm, deg/s, N m, mm, A or 1, and what a number stands for with `scale` and `to`"
            )
        };
        fields.complain_about("unit", message);
        return refused;
    };
    match (to, scale) {
        (None, None) => (from.unit, from.factor, from.offset + offset.unwrap_or(0.0)),
        (None, Some(scale)) => (from.unit, scale * from.factor, scale * from.offset + offset.unwrap_or(0.0)),
        (Some(to), scale) => match socam_units::conversion(to) {
            Some(to) => {
                let factor = scale.unwrap_or(1.0) * to.factor * from.factor;
                (to.unit, factor, offset.unwrap_or(0.0) * to.factor + to.offset)
            }
            None => {
                fields.complain_about("to", format!("`to` is \"{to}\", which is no unit known here"));
                refused
            }
        },
    }
}
