//! `[channels.NAME]`: channels, with the units of their columns checked against their quantities.

use socam_units::{Dimension, Unit};
use toml::Spanned;

use super::{
    raw::{Name, RawChannel},
    reader::Reader,
    wording::meant,
};
use crate::{Channel, ChannelTransform, ModelError, Quantity, Role, effects::QuantityKind};

/// SI unit of a recording's column by the suffix of its name; `None` where the name has no known suffix.
///
/// ```
/// assert_eq!(socam_model::column_unit("motor_speed_rad_s"), Some("rad/s"));
/// assert_eq!(socam_model::column_unit("motor_speed"), None);
/// ```
#[must_use]
pub fn column_unit(column: &str) -> Option<&'static str> {
    Unit::of_column(column).map(|(_, unit)| unit.symbol())
}

impl Reader<'_> {
    pub(super) fn channel(&mut self, name: Name, raw: RawChannel) -> Result<Channel, ModelError> {
        let label = name.get_ref();
        let place = raw.at.get_ref();
        if !self.places.iter().any(|(known, _)| known == place) {
            let places: Vec<&str> = self.places.iter().map(|(place, _)| place.as_str()).collect();
            let message = format!(
                "there is no place \"{place}\"{}; places are {}",
                meant(place, places.iter().copied()),
                places.join(", ")
            );
            return self.fail(&raw.at, message);
        }
        if let Some(std) = &raw.noise_std
            && !(std.get_ref().is_finite() && *std.get_ref() > 0.0)
        {
            return self.fail(std, format!("channels.{label}.noise_std must be positive"));
        }
        if !(raw.scale.is_none_or(|scale| scale.is_finite() && scale != 0.0) && raw.offset.is_finite()) {
            let message = format!(
                "channels.{label} needs a finite offset and a finite scale other than 0; leave scale out where the column is in SI"
            );
            return self.fail(&name, message);
        }
        if let Some(between) = &raw.between
            && raw.role == Role::Output
        {
            let message =
                format!("channels.{label}.between is for inputs: an output is compared at its samples only");
            return self.fail(between, message);
        }
        let take = match &raw.take {
            Some(take) => {
                let by_name = raw.column.as_ref().is_some_and(|column| is_angle(column.get_ref()));
                self.take(label, raw.role, by_name || raw.unit.is_some(), take)?
            }
            None => ChannelTransform::Value,
        };
        let gain =
            raw.gain.as_ref().map(|gain| self.parameter("gain", gain, QuantityKind::Ratio)).transpose()?;
        let (mut unit, suffix) = channel_unit(raw.quantity, self.rotational);
        if raw.quantity == Quantity::Signal {
            unit = self.signal_unit(label, &raw)?;
        }
        let factor = self.factor(&name, &raw, take, unit)?;
        let suffix = if raw.unit.is_some() { "_1" } else { suffix };
        let name = name.into_inner();
        Ok(Channel {
            column: raw.column.map_or_else(|| format!("{name}{suffix}"), Spanned::into_inner),
            name,
            role: raw.role,
            quantity: raw.quantity,
            at: raw.at.into_inner(),
            transform: take,
            scale: factor * raw.scale.unwrap_or(1.0),
            offset: raw.offset,
            gain,
            noise_std: raw.noise_std.map(Spanned::into_inner),
            estimate_offset: raw.estimate_offset,
            between: raw.between.map(Spanned::into_inner),
            unit,
        })
    }

    /// Unit of a signal: that of its column.
    fn signal_unit(&self, label: &str, raw: &RawChannel) -> Result<&'static str, ModelError> {
        if let Some(take) = &raw.take {
            return self
                .fail(take, format!("channels.{label}.take is not for a signal, which is read as recorded"));
        }
        if let Some(unit) = &raw.unit {
            let message = format!(
                "channels.{label}.unit is not for a signal, whose unit is that of its column, as in column = \"oil_K\""
            );
            return self.fail(unit, message);
        }
        let own = raw.column.as_ref().map_or(Some("1"), |column| column_unit(column.get_ref()));
        match (own, &raw.column) {
            (None, Some(column)) => self.fail(
                column,
                format!("channels.{label} is a signal, whose unit is that of its column; write a column with a suffix, as in column = \"oil_K\""),
            ),
            (own, _) => Ok(own.unwrap_or("1")),
        }
    }

    /// Factor from the transformed column to SI, to be multiplied by `scale`.
    fn factor(
        &self,
        name: &Name,
        raw: &RawChannel,
        transform: ChannelTransform,
        unit: &str,
    ) -> Result<f64, ModelError> {
        let label = name.get_ref();
        let (what, column) = (quantity_name(raw.quantity, self.rotational), raw.column.as_ref());
        let own = column.and_then(|column| column_unit(column.get_ref()));
        let is_wave = matches!(transform, ChannelTransform::Cos(_) | ChannelTransform::Sin(_));
        let Some(given) = &raw.unit else {
            if !is_wave && raw.scale.is_none() {
                self.check_suffix(label, what, column.zip(own), transform, unit)?;
            }
            return Ok(1.0);
        };
        if is_wave {
            let message = format!(
                "channels.{label}.unit has no meaning for a wave; take = {{ cos = .. }} reads an angle in rad"
            );
            return self.fail(given, message);
        }
        if let (Some(column), Some(own)) = (column, own)
            && own != "1"
        {
            let message = format!(
                "channels.{label}.unit is for a column whose name ends in _1, but \"{}\" is in {own} by its name; leave unit out",
                column.get_ref()
            );
            return self.fail(given, message);
        }
        match socam_units::parse(given.get_ref()) {
            Some(parsed)
                if dimension_of(given.get_ref(), transform)
                    == dimension_of(unit, ChannelTransform::Value) =>
            {
                Ok(parsed.factor)
            }
            _ => {
                let before = if transform == ChannelTransform::Rate {
                    "the rate of the column is taken, and "
                } else {
                    ""
                };
                let message = format!(
                    "channels.{label}.unit is \"{}\", but {before}{what} is in {unit}; write a unit that can be converted to that",
                    given.get_ref()
                );
                self.fail(given, message)
            }
        }
    }

    /// Whether a column's suffix names a unit of the dimension that the channel's quantity has. A file that gives a `scale` is not
    /// checked: the scale may convert between dimensions.
    fn check_suffix(
        &self,
        label: &str,
        what: &str,
        column: Option<(&Name, &'static str)>,
        transform: ChannelTransform,
        unit: &str,
    ) -> Result<(), ModelError> {
        let fits = |own: &str| {
            own != "1" && dimension_of(own, transform) == dimension_of(unit, ChannelTransform::Value)
        };
        let Some((column, own)) = column.filter(|(_, own)| !fits(own)) else { return Ok(()) };
        let (read, of) = match (own, transform) {
            ("1", _) => ("without a unit".to_owned(), "count".to_owned()),
            (_, ChannelTransform::Rate) => {
                (format!("in {own}, of which it takes the rate"), format!("{own} per second"))
            }
            _ => (format!("in {own}"), own.to_owned()),
        };
        let or = if own == "1" { "unit = \"...\" with what it counts, or " } else { "" };
        let message = format!(
            "channels.{label} reads the column \"{}\" {read}, but {what} is in {unit}; write {or}scale = X, where one {of} is X {unit}",
            column.get_ref()
        );
        self.fail(column, message)
    }

    /// Checks the transform of a channel. An output has none: its noise is that of its sensor as recorded.
    fn take(
        &self,
        label: &str,
        role: Role,
        is_angle: bool,
        take: &Spanned<ChannelTransform>,
    ) -> Result<ChannelTransform, ModelError> {
        if role == Role::Output {
            return self
                .fail(take, format!("channels.{label}.take is for inputs; an output is read as recorded"));
        }
        if !is_angle {
            let message = format!(
                "channels.{label}.take needs the column of an angle or position, such as column = \"encoder_rad\""
            );
            return self.fail(take, message);
        }
        match *take.get_ref() {
            ChannelTransform::Cos(order) | ChannelTransform::Sin(order)
                if !order.is_finite() || order == 0.0 =>
            {
                self.fail(take, format!("channels.{label}.take needs a finite order other than zero"))
            }
            taken => Ok(taken),
        }
    }
}

/// Whether a column holds angles or positions, by its unit's suffix.
fn is_angle(column: &str) -> bool {
    matches!(column_unit(column), Some("rad" | "m"))
}

/// Dimension of transformed values whose column is in `unit`; `None` for a temperature.
fn dimension_of(unit: &str, take: ChannelTransform) -> Option<Dimension> {
    let mut dimension = socam_units::parse(unit)?.dimension;
    dimension[2] -= i8::from(take == ChannelTransform::Rate);
    Some(dimension)
}

/// Name of a quantity in a sentence.
fn quantity_name(quantity: Quantity, rotational: bool) -> &'static str {
    match (quantity, rotational) {
        (Quantity::Speed, _) => "a speed",
        (Quantity::Angle, true) => "an angle",
        (Quantity::Angle, false) => "a position",
        (Quantity::Acceleration, _) => "an acceleration",
        (Quantity::Torque, true) => "a torque",
        (Quantity::Torque, false) => "a force",
        (Quantity::Reference, _) => "a reference",
        (Quantity::Voltage, _) => "a voltage",
        (Quantity::Current, _) => "a current",
        (Quantity::Signal, _) => "a signal",
        (Quantity::Time, _) => "a time",
        (Quantity::Turned, _) => "a turned angle",
        (Quantity::Change, _) => "a rate of change",
    }
}

/// SI unit and column suffix of a quantity.
fn channel_unit(quantity: Quantity, rotational: bool) -> (&'static str, &'static str) {
    match (quantity, rotational) {
        (Quantity::Speed, true) => ("rad/s", "_rad_s"),
        (Quantity::Speed, false) => ("m/s", "_m_s"),
        (Quantity::Angle | Quantity::Reference, true) => ("rad", "_rad"),
        (Quantity::Angle | Quantity::Reference, false) => ("m", "_m"),
        (Quantity::Acceleration, true) => ("rad/s2", "_rad_s2"),
        (Quantity::Acceleration, false) => ("m/s2", "_m_s2"),
        (Quantity::Torque, true) => ("N m", "_Nm"),
        (Quantity::Torque, false) => ("N", "_N"),
        (Quantity::Voltage, _) => ("V", "_V"),
        (Quantity::Current, _) => ("A", "_A"),
        (Quantity::Signal, _) => ("1", "_1"),
        (Quantity::Time, _) => ("s", "_s"),
        (Quantity::Turned, _) => ("rad", "_rad"),
        (Quantity::Change, _) => ("1/s", ""),
    }
}
