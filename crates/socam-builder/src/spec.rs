//! One drive or one measurement as it is written.

use crate::DescribeError;

/// `QUANTITY@PART[:COLUMN[*SCALE][ UNIT]]`.
pub(crate) struct Spec<'s> {
    pub(crate) text: &'s str,
    pub(crate) quantity: &'s str,
    pub(crate) part: &'s str,
    pub(crate) column: Option<String>,
    pub(crate) scale: Option<f64>,
    pub(crate) unit: Option<String>,
}

impl<'s> Spec<'s> {
    pub(crate) fn read(text: &'s str) -> Result<Self, DescribeError> {
        let wrong = |problem: &str| DescribeError::text(text, problem);
        let (quantity, rest) = text
            .split_once('@')
            .ok_or_else(|| wrong("write QUANTITY@PART:COLUMN, such as speed@motor:motor_speed_rad_s"))?;
        let (part, column) = rest.split_once(':').map_or((rest, None), |(part, column)| (part, Some(column)));
        let (column, unit) = match column.map(str::trim).and_then(|column| column.split_once(' ')) {
            Some((column, unit)) => (Some(column), Some(unit.trim().to_owned())),
            None => (column.map(str::trim), None),
        };
        let (column, scale) = match column.and_then(|column| column.split_once('*')) {
            Some((column, scale)) => {
                let number = scale.parse::<f64>().ok().filter(|scale| scale.is_finite() && *scale != 0.0);
                let number = number.ok_or_else(|| wrong("behind * stands a number other than 0"))?;
                (Some(column), Some(number))
            }
            None => (column, None),
        };
        let column = column.filter(|column| !column.is_empty()).map(str::to_owned);
        if let Some(unit) = unit.as_ref().filter(|unit| socam_units::parse(unit).is_none()) {
            return Err(wrong(&format!("\"{unit}\" is no unit; write one such as rpm, deg or mm")));
        }
        Ok(Self { text, quantity: quantity.trim(), part: part.trim(), column, scale, unit })
    }

    pub(crate) fn wrong(&self, problem: impl Into<String>) -> DescribeError {
        DescribeError::text(self.text, problem)
    }
}
