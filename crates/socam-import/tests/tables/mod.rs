//! One table in every text dialect and container, for tests of this crate and of the commands.

use std::fs::{File, write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_ipc::writer::FileWriter;
use arrow_schema::{DataType, Field, Schema};
use hdf5_pure::FileBuilder;
use parquet::data_type::DoubleType;
use parquet::file::writer::SerializedFileWriter;

/// A column's name and values.
pub(crate) type Column = (&'static str, Vec<f64>);

/// A table as `,` CSV first, then as `;` CSV with decimal commas, tab text, UTF-16, MATLAB, HDF5, Parquet and Feather.
pub(crate) fn write_all(folder: &Path, columns: &[Column]) -> Vec<PathBuf> {
    let place = |name: &str| folder.join(name);
    let comma = text(columns, ",");
    write(place("table.csv"), &comma).unwrap();
    write(place("semicolon.csv"), text(columns, ";").replace('.', ",")).unwrap();
    write(place("table.txt"), text(columns, "\t")).unwrap();
    let utf16: Vec<u8> =
        "\u{feff}".encode_utf16().chain(comma.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    write(place("utf16.csv"), utf16).unwrap();
    write(place("table.mat"), matlab(columns)).unwrap();
    hdf5(&place("table.h5"), columns);
    parquet(&place("table.parquet"), columns);
    feather(&place("table.feather"), columns);
    [
        "table.csv",
        "semicolon.csv",
        "table.txt",
        "utf16.csv",
        "table.mat",
        "table.h5",
        "table.parquet",
        "table.feather",
    ]
    .map(place)
    .to_vec()
}

fn text(columns: &[Column], separator: &str) -> String {
    let line = |cells: Vec<String>| cells.join(separator) + "\n";
    let header = line(columns.iter().map(|(name, _)| (*name).to_owned()).collect());
    let row = |row: usize| line(columns.iter().map(|(_, values)| values[row].to_string()).collect());
    header + &(0..columns[0].1.len()).map(row).collect::<String>()
}

/// Elements of a `.mat` file end at multiples of eight bytes.
fn element(kind: u32, content: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (content.len() as u32).to_le_bytes()].concat();
    bytes.extend(content);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn matlab(columns: &[Column]) -> Vec<u8> {
    let mut file = b"MATLAB 5.0 MAT-file, by hand".to_vec();
    file.resize(124, b' ');
    file.extend(b"\x00\x01IM");
    for (name, values) in columns {
        let dimensions = [1, values.len() as i32].map(i32::to_le_bytes).concat();
        let numbers: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let flags = [6_u32, 0].map(u32::to_le_bytes).concat();
        let parts =
            [element(6, &flags), element(5, &dimensions), element(1, name.as_bytes()), element(9, &numbers)];
        file.extend(element(14, &parts.concat()));
    }
    file
}

fn hdf5(path: &Path, columns: &[Column]) {
    let mut file = FileBuilder::new();
    for (name, values) in columns {
        file.create_dataset(name).with_f64_data(values).with_shape(&[values.len() as u64]);
    }
    write(path, file.finish().unwrap()).unwrap();
}

fn parquet(path: &Path, columns: &[Column]) {
    use parquet::basic::{Repetition, Type as Physical};
    use parquet::schema::types::Type;
    let field = |name: &str| {
        let field = Type::primitive_type_builder(name, Physical::DOUBLE);
        Arc::new(field.with_repetition(Repetition::REQUIRED).build().unwrap())
    };
    let fields = columns.iter().map(|(name, _)| field(name)).collect();
    let schema = Type::group_type_builder("run").with_fields(fields).build().unwrap();
    let file = File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::default()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for (_, values) in columns {
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(values, None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
}

fn feather(path: &Path, columns: &[Column]) {
    let field = |(name, _): &Column| Field::new(*name, DataType::Float64, true);
    let schema = Arc::new(Schema::new(columns.iter().map(field).collect::<Vec<_>>()));
    let arrays = columns.iter().map(|(_, values)| Arc::new(Float64Array::from(values.clone())) as ArrayRef);
    let batch = RecordBatch::try_new(schema.clone(), arrays.collect()).unwrap();
    let mut writer = FileWriter::try_new(File::create(path).unwrap(), &schema).unwrap();
    writer.write(&batch).unwrap();
    writer.finish().unwrap();
}
