//! Tables of measured pairs: CSV whose column names end in their units, as people read them from instruments.

use std::path::Path;

use socam_recording::Unit;
use socam_units::{Conversion, Meaning, column};

use crate::CalibrateError;

/// A column, in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Name of the column without the unit.
    pub name: String,
    /// SI unit.
    pub unit: Unit,
    /// One value for each row; `None` where the cell is empty.
    pub values: Vec<Option<f64>>,
}

/// A table of pairs.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// The file it came from.
    pub file: String,
    /// Columns that have a unit.
    pub columns: Vec<Measured>,
}

impl Pairs {
    /// Reads a CSV file: a header of names with units (`motor_speed_rpm`, `motor_speed_V`), then one row per measurement. Lines
    /// that begin with # are comments; columns without a unit are ignored.
    ///
    /// # Errors
    /// When it cannot be read, or a cell under a unit is no number.
    pub fn open(path: &Path) -> Result<Self, CalibrateError> {
        let file = path.display().to_string();
        let unread =
            |error: std::io::Error| CalibrateError::Read { file: file.clone(), problem: error.to_string() };
        let text = socam_recording::read_text(path).map_err(unread)?;
        Self::parse(file, &text)
    }

    /// Reads a table from its text.
    ///
    /// # Errors
    /// The errors of [`Self::open`].
    pub fn parse(file: String, text: &str) -> Result<Self, CalibrateError> {
        let line_error = |line, problem: String| CalibrateError::Line { file: file.clone(), line, problem };
        let mut reader =
            csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| line_error(1, error.to_string()))?.clone();
        let mut columns: Vec<(usize, Conversion, Measured)> = Vec::new();
        for (cell, title) in header.iter().enumerate() {
            let column = column(title, None);
            if let Meaning::Values(conversion) = column.meaning {
                let measured = Measured { name: column.name, unit: conversion.unit, values: Vec::new() };
                columns.push((cell, conversion, measured));
            }
        }
        if columns.len() < 2 {
            let problem = "expected at least two columns with a unit in their names, such as motor_speed_rpm,motor_speed_V";
            return Err(CalibrateError::File { file, problem: problem.into() });
        }
        for record in reader.records() {
            let record = record.map_err(|error| {
                line_error(
                    error.position().map_or(1, csv::Position::line),
                    "rows need as many cells as the header".into(),
                )
            })?;
            let line = record.position().map_or(1, csv::Position::line);
            for (cell, conversion, column) in &mut columns {
                let text = &record[*cell];
                let value = match text.parse::<f64>() {
                    _ if text.is_empty() => None,
                    Ok(value) if value.is_finite() => Some(conversion.si(value)),
                    _ => {
                        let problem = format!(
                            "`{text}` under {} is no number; leave the cell empty where nothing was read",
                            &header[*cell]
                        );
                        return Err(line_error(line, problem));
                    }
                };
                column.values.push(value);
            }
        }
        Ok(Self { file, columns: columns.into_iter().map(|(_, _, column)| column).collect() })
    }

    /// The column of a name and unit.
    #[must_use]
    pub fn column(&self, name: &str, unit: Unit) -> Option<&Measured> {
        self.columns.iter().find(|column| column.name == name && column.unit == unit)
    }

    /// Rows in which all these columns have a value.
    #[must_use]
    pub fn rows<const N: usize>(columns: [&Measured; N]) -> Vec<[f64; N]> {
        let rows = columns.iter().map(|column| column.values.len()).min().unwrap_or(0);
        let row = |i: usize| {
            let mut values = [0.0; N];
            for (value, column) in values.iter_mut().zip(columns) {
                *value = column.values[i]?;
            }
            Some(values)
        };
        (0..rows).filter_map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_converted_and_empty_cells_are_missing() {
        let pairs = Pairs::parse("p.csv".into(), "# by hand\nnote,w_rpm,w_mV\na,1000,6900\nb,,3\n").unwrap();
        let (speed, volts) = (pairs.column("w", Unit::RadPerS).unwrap(), pairs.column("w", Unit::V).unwrap());
        let rows = Pairs::rows([speed, volts]);
        assert_eq!(rows.len(), 1);
        assert!((rows[0][0] - 104.719_755).abs() < 1e-5 && (rows[0][1] - 6.9).abs() < 1e-12);
    }

    #[test]
    fn complaints_name_file_line_and_remedy() {
        let complain = |text: &str| Pairs::parse("p.csv".into(), text).unwrap_err().to_string();
        assert_eq!(
            complain("w_rpm,w_V\n1,2\nx,3\n"),
            "`p.csv`, line 3: `x` under w_rpm is no number; leave the cell empty where nothing was read"
        );
        assert!(complain("speed,volts\n1,2\n").contains("at least two columns with a unit"));
        assert!(complain("w_rpm,w_V\n1\n").contains("line 2: rows need as many cells"));
    }
}
