//! The table of a fleet as a Parquet file, and parts of it merged.
//!
//! The bytes depend on the rows and on [`About`] alone: rows are sorted by recording and id, row groups and pages have fixed sizes, and
//! nothing holds a time of writing.

mod read;

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::path::{Path, PathBuf};

use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use socam_model::Model;
use socam_recording::OutputFile;

use crate::batch::{schema, to_batch};
use crate::error::{FleetError, Result};
use crate::options::FleetOptions;
use crate::row::{Row, SCHEMA};
use crate::source::VERSION;
pub use read::Table;

/// Rows of a batch and of a row group. A group of rows with a hundred texts and numbers each takes some MB.
const GROUP_ROWS: usize = 4096;
/// Keys of the file's metadata: the value of the first is [`SCHEMA`], that of the second is [`About`].
const SCHEMA_KEY: &str = "socam.schema";
const ABOUT_KEY: &str = "socam.fleet";

/// Model, options and program version with which all rows of a table were computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// Name of the model.
    pub model: String,
    /// SHA-256 of the model file's text, hexadecimal.
    pub model_sha256: String,
    /// The options.
    pub options: FleetOptions,
    /// The seed.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
}

impl About {
    /// Description of a run with this model, options and seed.
    #[must_use]
    pub fn new(model: &Model, options: &FleetOptions, seed: u64) -> Self {
        Self {
            model: model.name.clone(),
            model_sha256: hash_of(model),
            options: options.clone(),
            seed,
            version: VERSION.into(),
        }
    }

    /// Whether this is the model.
    #[must_use]
    pub fn is_of(&self, model: &Model) -> bool {
        self.model_sha256 == hash_of(model)
    }

    /// First part in which two tables differ, as a phrase; `None` if they agree.
    fn differs(&self, other: &Self) -> Option<&'static str> {
        if self.model_sha256 != other.model_sha256 {
            Some("model")
        } else if self.version != other.version {
            Some("version of this program")
        } else if self != other {
            Some("set of options or reference")
        } else {
            None
        }
    }
}

fn hash_of(model: &Model) -> String {
    let hash = Sha256::digest(model.text.as_bytes());
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Writes rows, which must be sorted by recording and id, to a file that is replaced when all are written. Returns their number.
///
/// # Errors
/// When the file cannot be written, or a row is an error.
pub fn write(path: &Path, about: &About, rows: impl Iterator<Item = Result<Row>>) -> Result<u64> {
    let text = serde_json::to_string(about).map_err(|e| FleetError::table(path, e))?;
    write_as(path, &text, rows)
}

fn write_as(path: &Path, about: &str, rows: impl Iterator<Item = Result<Row>>) -> Result<u64> {
    let fail = |e: parquet::errors::ParquetError| FleetError::table(path, e);
    let target = OutputFile::create(path).map_err(|e| FleetError::table(path, e))?;
    let keys = [(SCHEMA_KEY, SCHEMA), (ABOUT_KEY, about)];
    let keys = keys.map(|(key, value)| KeyValue::new(key.to_owned(), value.to_owned())).to_vec();
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_max_row_group_row_count(Some(GROUP_ROWS))
        .set_key_value_metadata(Some(keys))
        .build();
    let mut writer = ArrowWriter::try_new(target, schema(), Some(properties)).map_err(fail)?;
    let mut group = Vec::with_capacity(GROUP_ROWS);
    let mut count = 0;
    for row in rows {
        group.push(row?);
        count += 1;
        if group.len() == GROUP_ROWS {
            writer.write(&to_batch(&group)?).map_err(fail)?;
            group.clear();
        }
    }
    if !group.is_empty() {
        writer.write(&to_batch(&group)?).map_err(fail)?;
    }
    let target = writer.into_inner().map_err(fail)?;
    target.commit().map_err(|e| FleetError::table(path, e))?;
    Ok(count)
}

/// Merges parts that were made alike into one table. Rows that several parts hold are written once. Returns the number of rows.
///
/// # Errors
/// When a part cannot be read or was made with another model, options or version.
pub fn merge(parts: &[PathBuf], target: &Path) -> Result<u64> {
    let tables = parts.iter().map(|path| Table::open(path)).collect::<Result<Vec<Table>>>()?;
    let Some(first) = tables.first() else {
        return Err(FleetError::table(target, "there is no part to merge"));
    };
    let text = first.text.clone();
    for table in &tables {
        if let Some(what) = first.about.differs(&table.about) {
            return Err(FleetError::Unlike { path: table.path.clone(), what: what.into() });
        }
    }
    write_as(target, &text, Merged::new(tables)?)
}

/// Rows of several sorted tables, sorted.
struct Merged {
    tables: Vec<Table>,
    /// The next row of each table, by recording and id.
    next: BinaryHeap<Reverse<Head>>,
    last: Option<(String, String)>,
}

/// A table's next row.
struct Head {
    row: Row,
    table: usize,
}

impl Head {
    fn key(&self) -> (&str, &str, usize) {
        (&self.row.recording, &self.row.id, self.table)
    }
}

impl PartialEq for Head {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Head {}

impl PartialOrd for Head {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Head {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.key().cmp(&other.key())
    }
}

impl Merged {
    fn new(tables: Vec<Table>) -> Result<Self> {
        let mut merged = Self { next: BinaryHeap::new(), last: None, tables };
        for table in 0..merged.tables.len() {
            merged.advance(table)?;
        }
        Ok(merged)
    }

    fn advance(&mut self, table: usize) -> Result<()> {
        if let Some(row) = self.tables[table].next() {
            self.next.push(Reverse(Head { row: row?, table }));
        }
        Ok(())
    }
}

impl Iterator for Merged {
    type Item = Result<Row>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let Reverse(Head { row, table }) = self.next.pop()?;
            if let Err(error) = self.advance(table) {
                return Some(Err(error));
            }
            let key = (row.recording.clone(), row.id.clone());
            if self.last.as_ref() != Some(&key) {
                self.last = Some(key);
                return Some(Ok(row));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::tests::full;

    #[test]
    fn merged_parts_are_the_whole_table_byte_for_byte() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let model = Model::builtin("two-mass").unwrap();
        let about = About::new(&model, &FleetOptions::default(), 1);
        // More than one group of rows.
        let rows: Vec<Row> = (0..GROUP_ROWS + 100)
            .map(|k| Row { recording: format!("{k:06}"), excess: Some(k as f64 / 7.0), ..full() })
            .collect();
        let every = |of: usize, number: usize| rows.iter().skip(number).step_by(of).cloned().map(Ok);
        write(&path("whole"), &about, every(1, 0)).unwrap();
        write(&path("1"), &about, every(2, 0)).unwrap();
        write(&path("2"), &about, every(2, 1)).unwrap();
        // The second part is given twice, as by a job that was repeated.
        merge(&[path("2"), path("1"), path("2")], &path("merged")).unwrap();
        assert_eq!(std::fs::read(path("whole")).unwrap(), std::fs::read(path("merged")).unwrap());
        assert_eq!(Table::open(&path("merged")).unwrap().map(Result::unwrap).collect::<Vec<_>>(), rows);

        let other = About::new(&model, &FleetOptions { most_effects: 1, ..FleetOptions::default() }, 1);
        write(&path("3"), &other, every(2, 1)).unwrap();
        let problem = merge(&[path("1"), path("3")], &path("merged")).unwrap_err().to_string();
        assert!(problem.contains("another set of options"), "{problem}");
        std::fs::write(path("text"), "no table").unwrap();
        assert!(matches!(Table::open(&path("text")), Err(FleetError::Table { .. })));
    }
}
