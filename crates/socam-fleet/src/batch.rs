//! Rows as Arrow columns, and back.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_schema::{DataType, Field, FieldRef, Schema, SchemaRef, TimeUnit};

use crate::error::Result;
use crate::row::Row;

/// The schema of the table. Its columns have the names of [`Row`]'s fields; lists hold structs.
#[must_use]
pub fn schema() -> SchemaRef {
    Arc::new(Schema::new(fields()).with_metadata(HashMap::new()))
}

/// Rows as one batch of columns.
///
/// # Errors
/// When the rows do not fit the schema, which is a defect of this crate.
pub fn to_batch(rows: &[Row]) -> Result<RecordBatch> {
    Ok(serde_arrow::to_record_batch(&fields(), &rows)?)
}

/// Rows of a batch.
///
/// # Errors
/// When the batch has other columns.
pub fn from_batch(batch: &RecordBatch) -> Result<Vec<Row>> {
    Ok(serde_arrow::from_record_batch(batch)?)
}

fn fields() -> Vec<FieldRef> {
    let finding = [
        text("effect"),
        text("place"),
        optional("parameter", DataType::Utf8),
        number("size"),
        number("low"),
        number("high"),
        text("unit"),
        number("share"),
        required("material", DataType::Boolean),
        number("log_score_gain"),
        number("log_score_std"),
        list("rivals", DataType::Utf8),
        text("sentence"),
    ];
    let parameter = [
        text("name"),
        number("value"),
        number("std"),
        number("low"),
        number("high"),
        text("unit"),
        required("determined", DataType::Boolean),
    ];
    let channel = [text("name"), text("unit"), number("noise_std"), number("rms"), number("rms_corrected")];
    vec![
        text("id"),
        text("recording"),
        optional("machine", DataType::Utf8),
        optional("date", DataType::Timestamp(TimeUnit::Millisecond, Some("UTC".into()))),
        text("status"),
        text("message"),
        text("stage"),
        optional("verdict", DataType::Utf8),
        number("p_value"),
        number("excess"),
        optional("samples", DataType::UInt64),
        number("duration_s"),
        list("findings", DataType::Struct(finding.to_vec().into())),
        list("parameters", DataType::Struct(parameter.to_vec().into())),
        list("channels", DataType::Struct(channel.to_vec().into())),
        list("warnings", DataType::Utf8),
        text("model"),
        text("version"),
    ]
}

fn required(name: &str, kind: DataType) -> FieldRef {
    Arc::new(Field::new(name, kind, false))
}

fn optional(name: &str, kind: DataType) -> FieldRef {
    Arc::new(Field::new(name, kind, true))
}

fn text(name: &str) -> FieldRef {
    required(name, DataType::Utf8)
}

fn number(name: &str) -> FieldRef {
    optional(name, DataType::Float64)
}

fn list(name: &str, item: DataType) -> FieldRef {
    required(name, DataType::List(Arc::new(Field::new("item", item, false))))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::row::{ChannelFit, Finding, Parameter, Stage, Status, Verdict};

    /// A row in which every column holds something.
    pub(crate) fn full() -> Row {
        Row {
            id: "ab".into(),
            recording: "SN1/2026-01-02.mcap".into(),
            machine: Some("SN1".into()),
            date: Some(1_767_312_000_123),
            status: Status::Ok,
            message: String::new(),
            stage: Stage::Diagnosis,
            verdict: Some(Verdict::MissingPhysics),
            p_value: Some(1e-3),
            excess: Some(0.1 + 0.2),
            samples: Some(5000),
            duration_s: Some(5.0),
            findings: vec![Finding {
                effect: "an_effect".into(),
                place: "load".into(),
                parameter: Some("torque".into()),
                size: Some(0.1),
                low: Some(0.05),
                high: None,
                unit: "N m".into(),
                share: Some(0.2),
                material: true,
                log_score_gain: Some(30.0),
                log_score_std: Some(5.0),
                rivals: vec!["another_effect@load".into()],
                sentence: "It rubs.".into(),
            }],
            parameters: vec![Parameter {
                name: "stiffness".into(),
                value: Some(120.0),
                std: Some(1.0),
                low: Some(118.0),
                high: Some(122.0),
                unit: "N m/rad".into(),
                determined: true,
            }],
            channels: vec![ChannelFit {
                name: "load_speed".into(),
                unit: "rad/s".into(),
                noise_std: Some(0.1),
                rms: Some(0.2),
                rms_corrected: None,
            }],
            warnings: vec!["a gap".into()],
            model: "two-mass".into(),
            version: "0.1.0".into(),
        }
    }

    #[test]
    fn rows_are_the_same_after_a_way_through_columns() {
        let bad = Row {
            machine: None,
            date: None,
            status: Status::Unreadable,
            stage: Stage::Read,
            verdict: None,
            p_value: None,
            findings: Vec::new(),
            parameters: Vec::new(),
            ..full()
        };
        let rows = vec![full(), bad];
        let batch = to_batch(&rows).unwrap();
        assert_eq!(batch.schema(), schema());
        assert_eq!(from_batch(&batch).unwrap(), rows);
    }
}
