//! Files of other programs, made by the libraries of their formats where those write.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use arrow_array::{Float64Array, RecordBatch};
use arrow_ipc::writer::FileWriter;
use arrow_schema::{DataType, Field, Schema};
use hdf5_pure::FileBuilder;
use mdf4_rs::{DecodedValue, MdfWriter};
use parquet::data_type::DoubleType;
use parquet::file::writer::SerializedFileWriter;

use super::robots;

const ROWS: usize = 24;

fn values() -> [Vec<f64>; 2] {
    let row = |step: f64| (0..ROWS).map(move |k| step * k as f64).collect();
    [row(0.001), row(2.5)]
}

/// One file of each format; a format whose file cannot be made has none.
pub(crate) fn foreign(folder: &Path) -> Vec<Vec<u8>> {
    let made = [arrow(), parquet(), hdf5(), matlab(), tdms(), json_log(), mdf(folder)];
    made.into_iter().chain(robots::binary(folder)).flatten().collect()
}

fn arrow() -> Option<Vec<u8>> {
    let field = |name: &str| Field::new(name, DataType::Float64, true);
    let schema = Arc::new(Schema::new(vec![field("t_s"), field("speed_rpm")]));
    let [time, speed] = values().map(|values| Arc::new(Float64Array::from(values)) as _);
    let batch = RecordBatch::try_new(schema.clone(), vec![time, speed]).ok()?;
    let mut bytes = Vec::new();
    let mut writer = FileWriter::try_new(&mut bytes, &schema).ok()?;
    writer.write(&batch).ok()?;
    writer.finish().ok()?;
    drop(writer);
    Some(bytes)
}

fn parquet() -> Option<Vec<u8>> {
    let schema = "message run { required double t_s; required double speed_rpm; }";
    let schema = Arc::new(parquet::schema::parser::parse_message_type(schema).ok()?);
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::default()).ok()?;
    let mut group = writer.next_row_group().ok()?;
    for values in values() {
        let mut column = group.next_column().ok()??;
        column.typed::<DoubleType>().write_batch(&values, None, None).ok()?;
        column.close().ok()?;
    }
    group.close().ok()?;
    writer.close().ok()?;
    Some(bytes)
}

fn hdf5() -> Option<Vec<u8>> {
    let mut file = FileBuilder::new();
    for (name, values) in ["time_s", "speed_rpm"].into_iter().zip(values()) {
        file.create_dataset(name).with_f64_data(&values).with_shape(&[ROWS as u64]);
    }
    file.finish().ok()
}

fn mdf(folder: &Path) -> Option<Vec<u8>> {
    let path = folder.join("seed.mf4");
    let mut writer = MdfWriter::new(path.to_str()?).ok()?;
    writer.init_mdf_file().ok()?;
    let group = writer.add_channel_group(None, |_| {}).ok()?;
    let channel = |name: &'static str, is_master: bool| {
        move |channel: &mut mdf4_rs::blocks::ChannelBlock| {
            channel.data_type = mdf4_rs::DataType::FloatLE;
            channel.name = Some(name.into());
            channel.bit_count = 64;
            channel.channel_type = if is_master { 2 } else { 0 };
        }
    };
    let time = writer.add_channel(&group, None, channel("time", true)).ok()?;
    writer.add_channel(&group, Some(&time), channel("speed_rpm", false)).ok()?;
    writer.start_data_block_for_cg(&group, 0).ok()?;
    let [times, speeds] = values();
    for (time, speed) in times.into_iter().zip(speeds) {
        writer.write_record(&group, &[DecodedValue::Float(time), DecodedValue::Float(speed)]).ok()?;
    }
    writer.finish_data_block(&group).ok()?;
    writer.finalize().ok()?;
    std::fs::read(path).ok()
}

/// Elements of a `.mat` file end at multiples of eight bytes.
fn element(kind: u32, content: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (content.len() as u32).to_le_bytes()].concat();
    bytes.extend(content);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn matlab() -> Option<Vec<u8>> {
    let mut file = b"MATLAB 5.0 MAT-file, by hand".to_vec();
    file.resize(124, b' ');
    file.extend(b"\x00\x01IM");
    for (name, values) in ["t_s", "speed_rpm"].into_iter().zip(values()) {
        let dimensions = [1, ROWS as i32].map(i32::to_le_bytes).concat();
        let numbers: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let flags = [6_u32, 0].map(u32::to_le_bytes).concat();
        let parts =
            [element(6, &flags), element(5, &dimensions), element(1, name.as_bytes()), element(9, &numbers)];
        file.extend(element(14, &parts.concat()));
    }
    Some(file)
}

fn tdms() -> Option<Vec<u8>> {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let mut description = 2_u32.to_le_bytes().to_vec();
    for name in ["time_s", "speed_rpm"] {
        description.extend(text(&format!("/'DAQ'/'{name}'")));
        description.extend([20_u32, 10, 1].map(u32::to_le_bytes).concat());
        description.extend((ROWS as u64).to_le_bytes());
        description.extend(0_u32.to_le_bytes());
    }
    let numbers: Vec<u8> = values().iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    let mut file = b"TDSm".to_vec();
    file.extend([0x0e_u32, 4713].map(u32::to_le_bytes).concat());
    let lengths = [description.len() + numbers.len(), description.len()];
    file.extend(lengths.map(|length| (length as u64).to_le_bytes()).concat());
    file.extend(description);
    file.extend(numbers);
    // A second segment repeats the layout of the first.
    file.extend(file.clone());
    Some(file)
}

fn json_log() -> Option<Vec<u8>> {
    let options = mcap::WriteOptions::new().compression(None);
    let mut writer = options.create(std::io::Cursor::new(Vec::new())).ok()?;
    let schema = writer.add_schema("State", "jsonschema", b"{}").ok()?;
    let channel = writer.add_channel(schema, "/state", "json", &BTreeMap::new()).ok()?;
    for k in 0..ROWS as u64 {
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: k as u32,
            log_time: 1_000_000 * k,
            publish_time: 1_000_000 * k,
        };
        let text = format!(
            "{{\"speed_rpm\": {k}.5, \"stamp\": {{\"sec\": {k}, \"nanosec\": 5}}, \"list\": [1, 2]}}"
        );
        writer.write_to_known_channel(&header, text.as_bytes()).ok()?;
    }
    writer.finish().ok()?;
    Some(writer.into_inner().into_inner())
}

/// Tables of text as other programs write them.
pub(crate) fn foreign_tables(_: &Path) -> Vec<Vec<u8>> {
    let tables = super::texts([
        "Zeit [ms];Drehzahl [1/min]\n0,0;1,5\n1,0;2,5\n2,0;3,5\n",
        "Bench 3\n\ntime,speed\ns,rpm\n0,1\n1,2\n2,3\n",
        "timestamp\tx [mm]\n2024-05-01 12:00:00.0\t1\n2024-05-01 12:00:00.1\t2\n",
        "# t_s x_rad\n 0.0 1.0\n 0.1 2.0\n",
        "\"t [s]\",\"n, rpm\",mode\n0,1,\"a,b\"\n1,2,c\n",
        "Record Length,5.0e+00,,-0.0010,0.5,\nVertical Units,V,,0.0000,1.5,\nSource,CH1,,0.0010,2.5,\n",
    ]);
    tables.into_iter().chain(robots::text().map(String::into_bytes)).collect()
}

/// Mappings of signals to channels.
pub(crate) fn mappings(_: &Path) -> Vec<Vec<u8>> {
    super::texts([
        "schema = \"socam.import/1\"\n[text]\nseparator = \";\"\ndecimal = \",\"\nfirst_line = 2\nheader_line = 1\n[[clocks]]\ntime = \"t\"\n\
         unit = \"ms\"\n[channels.speed]\nsignal = \"n\"\nunit = \"rpm\"\n",
        "[[clocks]]\nrate_Hz = 1000\nstamps = \"jitter\"\n[channels.angle]\nsignal = \"a/b\"\nunit = \"counts\"\ncounts_per_turn = 4096\n\
         wrap = 65536\n[channels.torque]\nsignal = \"i\"\nunit = \"mA\"\nscale = 0.1\nto = \"N m\"\nmissing = -1\nbetween = \"hold\"\n",
    ])
}
