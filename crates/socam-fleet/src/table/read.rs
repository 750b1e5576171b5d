//! A table that is read row by row: all of it, or the rows of one machine.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use arrow_array::{Array, BooleanArray, RecordBatch, StringArray};
use arrow_schema::ArrowError;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{
    ArrowPredicateFn, ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder, RowFilter,
};
use parquet::file::metadata::KeyValue;

use super::{ABOUT_KEY, About, GROUP_ROWS, SCHEMA_KEY};
use crate::batch::from_batch;
use crate::error::{FleetError, Result};
use crate::row::{Row, SCHEMA};

/// First bytes of a Parquet file.
const MAGIC: [u8; 4] = *b"PAR1";
/// Prefix common to all versions of the schema.
const SCHEMAS: &str = "socam.fleet/";

/// A table that is read row by row.
pub struct Table {
    pub(super) path: PathBuf,
    /// Model, options and program version with which the rows were computed.
    pub about: About,
    /// Text of `about` as written in the file: numbers parsed from text may differ from it in the last bit.
    pub(super) text: String,
    count: u64,
    /// `None` behind the end, or behind what cannot be read.
    batches: Option<ParquetRecordBatchReader>,
    rows: std::vec::IntoIter<Row>,
}

type Builder = ParquetRecordBatchReaderBuilder<File>;

impl Table {
    /// Whether a file is the table of a fleet, of this or another version: reads its ends only.
    #[must_use]
    pub fn is_one(path: &Path) -> bool {
        let mut magic = [0; 4];
        let is_parquet = path.is_file()
            && File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok()
            && magic == MAGIC;
        let schema =
            || value(builder(path).ok()?.metadata().file_metadata().key_value_metadata(), SCHEMA_KEY);
        is_parquet && schema().is_some_and(|schema| schema.starts_with(SCHEMAS))
    }

    /// Opens a table.
    ///
    /// # Errors
    /// When the file cannot be read, or is no table of this schema.
    pub fn open(path: &Path) -> Result<Self> {
        Self::of(path, builder(path)?)
    }

    /// The rows of one machine, by [`Row::machine_name`]. Of all other rows only the names are read.
    ///
    /// # Errors
    /// The errors of [`Self::open`].
    pub fn of_machine(path: &Path, machine: &str) -> Result<Self> {
        let builder = builder(path)?;
        let mask = ProjectionMask::columns(builder.parquet_schema(), ["recording", "machine"]);
        let machine = machine.to_owned();
        let filter = ArrowPredicateFn::new(mask, move |batch| is_of(&batch, &machine));
        Self::of(path, builder.with_row_filter(RowFilter::new(vec![Box::new(filter)])))
    }

    fn of(path: &Path, builder: Builder) -> Result<Self> {
        let of_file = builder.metadata().file_metadata();
        let keys = of_file.key_value_metadata();
        match value(keys, SCHEMA_KEY).as_deref() {
            Some(SCHEMA) => {}
            other => {
                let found = other.unwrap_or("none");
                let problem = format!("its schema is {found}; expected {SCHEMA}");
                return Err(FleetError::table(path, problem));
            }
        }
        let text = value(keys, ABOUT_KEY).unwrap_or_default();
        let about = serde_json::from_str(&text).map_err(|e| FleetError::table(path, e))?;
        let count = u64::try_from(of_file.num_rows()).unwrap_or_default();
        let batches = fenced(path, || {
            builder.with_batch_size(GROUP_ROWS).build().map_err(|e| FleetError::table(path, e))
        })?;
        Ok(Self {
            path: path.into(),
            about,
            text,
            count,
            batches: Some(batches),
            rows: Vec::new().into_iter(),
        })
    }

    /// Number of rows in the file.
    #[must_use]
    pub fn count_in_file(&self) -> u64 {
        self.count
    }
}

fn builder(path: &Path) -> Result<Builder> {
    let file = File::open(path).map_err(|e| FleetError::io(path, "open", e))?;
    fenced(path, || Builder::try_new(file).map_err(|e| FleetError::table(path, e)))
}

/// The library that reads Parquet panics at some damaged files.
fn fenced<T>(path: &Path, read: impl FnOnce() -> Result<T>) -> Result<T> {
    socam_import::fenced(read).unwrap_or_else(|| Err(FleetError::table(path, "it is damaged")))
}

fn value(keys: Option<&Vec<KeyValue>>, name: &str) -> Option<String> {
    keys?.iter().find(|key| key.key == name)?.value.clone()
}

/// Mask of the rows of a batch of names that belong to a machine.
fn is_of(batch: &RecordBatch, machine: &str) -> std::result::Result<BooleanArray, ArrowError> {
    let column = |name: &str| {
        let texts =
            batch.column_by_name(name).and_then(|column| column.as_any().downcast_ref::<StringArray>());
        texts.ok_or_else(|| ArrowError::SchemaError(format!("the column `{name}` holds no text")))
    };
    let (recordings, machines) = (column("recording")?, column("machine")?);
    let own = (0..batch.num_rows()).map(|row| {
        let named = if machines.is_null(row) { recordings } else { machines };
        Some(named.value(row) == machine)
    });
    Ok(own.collect())
}

impl Iterator for Table {
    type Item = Result<Row>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(row) = self.rows.next() {
                return Some(Ok(row));
            }
            let (path, batches) = (&self.path, self.batches.as_mut()?);
            let next = fenced(path, || {
                let Some(batch) = batches.next() else { return Ok(None) };
                let batch = batch.map_err(|e| FleetError::table(path, e))?;
                from_batch(&batch).map(Some).map_err(|e| FleetError::table(path, e))
            });
            match next {
                Ok(None) => return None,
                Ok(Some(rows)) => self.rows = rows.into_iter(),
                Err(error) => {
                    self.batches = None;
                    return Some(Err(error));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::write;
    use super::*;
    use crate::batch::tests::full;
    use crate::options::FleetOptions;

    #[test]
    fn a_table_is_known_by_its_key_and_a_machine_by_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fleet.parquet");
        let model = socam_model::Model::builtin("two-mass").unwrap();
        let about = About::new(&model, &FleetOptions::default(), 1);
        assert!(about.is_of(&model) && !about.is_of(&socam_model::Model::builtin("emps").unwrap()));
        let rows: Vec<Row> = (0..GROUP_ROWS + 100)
            .map(|k| Row {
                recording: format!("{k:06}"),
                machine: (k % 1000 != 7).then(|| format!("SN{}", k % 900)),
                ..full()
            })
            .collect();
        write(&path, &about, rows.iter().cloned().map(Ok)).unwrap();
        assert!(Table::is_one(&path));
        assert_eq!(Table::open(&path).unwrap().count_in_file(), rows.len() as u64);
        for name in ["SN0", "SN100", "001007", "nobody"] {
            let found: Vec<Row> = Table::of_machine(&path, name).unwrap().map(Result::unwrap).collect();
            let expected: Vec<Row> = rows.iter().filter(|row| row.machine_name() == name).cloned().collect();
            assert_eq!(found, expected, "{name}");
            assert_eq!(found.is_empty(), name == "nobody");
        }
        std::fs::write(folder.path().join("text"), "no table").unwrap();
        assert!(!Table::is_one(&folder.path().join("text")) && !Table::is_one(folder.path()));
    }

    /// Whichever byte is damaged, reading ends with one sentence or with rows, never with a panic.
    #[test]
    fn a_damaged_table_gives_one_sentence() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fleet.parquet");
        let about =
            About::new(&socam_model::Model::builtin("two-mass").unwrap(), &FleetOptions::default(), 1);
        write(&path, &about, (0..3).map(|k| Ok(Row { recording: format!("{k}"), ..full() }))).unwrap();
        let whole = std::fs::read(&path).unwrap();
        let read = |bytes: &[u8]| -> Result<Vec<Row>> {
            std::fs::write(&path, bytes).unwrap();
            let _ = Table::of_machine(&path, "SN1").map(Iterator::count);
            Table::open(&path)?.collect()
        };
        let mut refused = 0;
        for place in (0..whole.len()).step_by(whole.len() / 400) {
            let mut bytes = whole.clone();
            bytes[place] ^= 0x15;
            if let Err(error) = read(&bytes) {
                refused += 1;
                let text = error.to_string();
                assert!(!text.contains('\n') && text.contains("fleet.parquet"), "{place}: {text}");
            }
        }
        assert!(refused > 50, "{refused}");
        assert!(read(&whole[..whole.len() / 2]).is_err());
    }
}
