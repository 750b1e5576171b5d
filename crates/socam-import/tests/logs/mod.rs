//! Writers of binary logs and of logs of a CAN bus.

use std::io::Write;
use std::path::Path;

use flate2::{Compression, write::ZlibEncoder};

pub(crate) const ROWS: usize = 200;

/// A number that a signal of 16 bits holds.
pub(crate) fn raw(row: usize) -> i16 {
    (row * 37 % 2001) as i16 - 1000
}

pub(crate) fn speed_rad_s(row: usize) -> f64 {
    0.5 * f64::from(raw(row)) + 10.0
}

pub(crate) fn torque_nm(row: usize) -> f64 {
    -1e-3 * f64::from(raw(row))
}

fn time_us(row: usize) -> u64 {
    5_000_000 + 2000 * row as u64
}

/// Two signals of both orders of bytes, one of 29 bits of identifier, a multiplexer, and a float.
pub(crate) const DBC: &str = r#"VERSION ""

NS_ :

BS_:

BU_: Motor

BO_ 257 Drive: 8 Motor
 SG_ speed : 0|16@1- (0.5,10) [-500|500] "rad/s" Vector__XXX
 SG_ torque : 23|16@0- (-0.001,0) [-10|10] "Nm" Vector__XXX

BO_ 2566844672 Status: 8 Motor
 SG_ Page M : 0|8@1+ (1,0) [0|255] "" Vector__XXX
 SG_ Current m0 : 8|32@1- (1,0) [0|0] "A" Vector__XXX
 SG_ Temperature m1 : 15|16@0+ (0.5,-40) [0|0] "degC" Vector__XXX

SIG_VALTYPE_ 2566844672 Current : 1;
"#;

/// Bytes of the frame `Drive`.
fn drive(row: usize) -> [u8; 8] {
    let [speed, torque] = [raw(row).to_le_bytes(), raw(row).to_be_bytes()];
    [speed[0], speed[1], torque[0], torque[1], 0, 0, 0, 0]
}

fn hex(bytes: &[u8], between: &str) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(between)
}

fn rows(line: impl Fn(usize) -> String) -> String {
    (0..ROWS).map(|row| line(row) + "\n").collect()
}

/// Frames of a multiplexed message, its pages in turn.
pub(crate) fn multiplexed() -> String {
    rows(|row| {
        let data = if row % 2 == 0 {
            [[0].as_slice(), &(row as f32).to_le_bytes(), &[0; 3]].concat()
        } else {
            [[1].as_slice(), &(300 + row as u16 / 2).to_be_bytes(), &[0; 5]].concat()
        };
        format!("({:.6}) can0 18FEF100#{}", 1e-6 * time_us(row) as f64, hex(&data, ""))
    })
}

pub(crate) fn logs() -> Vec<(&'static str, Vec<u8>)> {
    let at_s = |row: usize| 1e-6 * time_us(row) as f64;
    let text = |text: String| text.into_bytes();
    let asc = "date Sat Jan  1 00:00:00.000 2021\nbase hex  timestamps absolute\ninternal events logged\n   0.000000 Start of measurement\n";
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("run.db3");
    self::bag(&bag, &[("bench_msgs/msg/State", "/state")], true);
    vec![
        ("drive.wpilog", wpilog()),
        ("drive.ulg", ulog()),
        ("drive.log", text(rows(|row| format!("({:.6}) can0 101#{}", at_s(row), hex(&drive(row), ""))))),
        ("fd.log", text(rows(|row| format!("({:.6}) can0 101##1{}", at_s(row), hex(&drive(row), ""))))),
        (
            "print.log",
            text(rows(|row| format!(" ({:.6})  can0  101   [8]  {}", at_s(row), hex(&drive(row), " ")))),
        ),
        (
            "drive.asc",
            text(
                asc.to_owned()
                    + &rows(|row| {
                        format!("   {:.6} 1  101             Rx   d 8 {}", at_s(row), hex(&drive(row), " "))
                    }),
            ),
        ),
        ("drive.blf", blf()),
        ("run.db3", std::fs::read(bag).unwrap()),
    ]
}

fn record(id: u32, time_us: u64, payload: &[u8]) -> Vec<u8> {
    // Four bytes of number, two of length, eight of time.
    let mut bytes = vec![0b0111_0111];
    bytes.extend(id.to_le_bytes());
    bytes.extend((payload.len() as u16).to_le_bytes());
    bytes.extend(time_us.to_le_bytes());
    bytes.extend(payload);
    bytes
}

fn start(id: u32, name: &str, kind: &str, metadata: &str) -> Vec<u8> {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let payload = [&[0], id.to_le_bytes().as_slice(), &text(name), &text(kind), &text(metadata)].concat();
    record(0, 0, &payload)
}

fn wpilog() -> Vec<u8> {
    let mut bytes = b"WPILOG\x00\x01\x03\x00\x00\x00{ }".to_vec();
    bytes.extend(start(1, "speed_rad_s", "double", ""));
    bytes.extend(start(7, "torque", "int64", r#"{"unit": "mNm"}"#));
    bytes.extend(start(9, "phase", "float[]", r#"{"unit": "A"}"#));
    for row in 0..ROWS {
        bytes.extend(record(1, time_us(row), &speed_rad_s(row).to_le_bytes()));
        bytes.extend(record(7, time_us(row), &(-i64::from(raw(row))).to_le_bytes()));
        bytes.extend(record(9, time_us(row), &[row as f32, 0.5].map(f32::to_le_bytes).concat()));
    }
    bytes
}

/// A log as WPILib's class for SysId writes it.
pub(crate) fn sysid() -> Vec<u8> {
    let mut bytes = b"WPILOG\x00\x01\x00\x00\x00\x00".to_vec();
    bytes.extend(start(1, "sysid-test-state-drive", "string", ""));
    bytes.extend(start(2, "voltage-left-drive", "double", "Volt"));
    bytes.extend(start(3, "position-left-drive", "double", "Rotation"));
    bytes.extend(start(4, "velocity-left-drive", "double", "Rotation per Second"));
    bytes.extend(start(5, "Pose", "struct:Pose2d", ""));
    for (row, state) in
        ["quasistatic-forward", "quasistatic-forward", "quasistatic-forward", "none"].iter().enumerate()
    {
        let at_us = 1_000_000 + 20_000 * row as u64;
        bytes.extend(record(1, at_us, state.as_bytes()));
        for (id, value) in [(2, 0.5), (3, 1.0), (4, 2.0)] {
            bytes.extend(record(id, at_us, &(value * row as f64).to_le_bytes()));
        }
        bytes.extend(record(5, at_us, &[0; 24]));
    }
    bytes
}

fn message(kind: u8, payload: &[u8]) -> Vec<u8> {
    [&(payload.len() as u16).to_le_bytes(), [kind].as_slice(), payload].concat()
}

fn ulog() -> Vec<u8> {
    let mut bytes = b"ULog\x01\x12\x35\x01".to_vec();
    bytes.extend(0_u64.to_le_bytes());
    bytes.extend(message(b'B', &[0; 40]));
    bytes.extend(message(b'I', b"\x0achar[3] sysPX4"));
    bytes.extend(message(
        b'F',
        b"axis:double speed_rad_s;float[2] load;float temperature_degC;uint8_t[4] _padding0;",
    ));
    bytes.extend(message(
        b'F',
        b"drive:uint64_t timestamp;axis axis;int16_t torque_mNm;uint8_t[6] _padding0;",
    ));
    bytes.extend(message(b'A', b"\x00\x05\x00drive"));
    for row in 0..ROWS {
        let mut data = 5_u16.to_le_bytes().to_vec();
        data.extend(time_us(row).to_le_bytes());
        data.extend(speed_rad_s(row).to_le_bytes());
        data.extend([0.5_f32, 0.5, 20.0].map(f32::to_le_bytes).concat());
        data.extend([0; 4]);
        data.extend((-raw(row)).to_le_bytes());
        bytes.extend(message(b'D', &data));
        if row % 10 == 9 {
            bytes.extend(message(b'S', &[0x2f, 0x73, 0x13, 0x20, 0x25, 0x0c, 0xbb, 0x12]));
        }
        if row == 20 {
            bytes.extend(message(b'O', &7_u16.to_le_bytes()));
        }
    }
    bytes
}

fn object(kind: u32, body: &[u8]) -> Vec<u8> {
    let length = 16 + body.len() as u32;
    let mut bytes = b"LOBJ".to_vec();
    bytes.extend([16_u16, 1].map(u16::to_le_bytes).concat());
    bytes.extend([length, kind].map(u32::to_le_bytes).concat());
    bytes.extend(body);
    bytes
}

/// Half of the frames are of CAN FD, and every container is cut within a frame.
fn blf() -> Vec<u8> {
    let mut frames = Vec::new();
    for row in 0..ROWS {
        let mut body = 2_u32.to_le_bytes().to_vec();
        body.extend([0; 4]);
        body.extend((1000 * time_us(row)).to_le_bytes());
        body.extend(1_u16.to_le_bytes());
        body.extend([0, 8]);
        body.extend(0x101_u32.to_le_bytes());
        if row % 2 == 0 {
            body.extend(drive(row));
            frames.extend(object(86, &body));
        } else {
            body.extend([0; 5]);
            body.extend([1, 8, 0, 0, 0, 0, 0]);
            body.extend(drive(row));
            body.extend([0; 56]);
            frames.extend(object(100, &body));
        }
    }
    let mut bytes = b"LOGG".to_vec();
    bytes.extend(144_u32.to_le_bytes());
    bytes.resize(144, 0);
    for (index, part) in frames.chunks(1111).enumerate() {
        let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
        packed.write_all(part).unwrap();
        let (method, packed) =
            if index % 3 == 2 { (0_u16, part.to_vec()) } else { (2, packed.finish().unwrap()) };
        let mut body = method.to_le_bytes().to_vec();
        body.extend([0; 6]);
        body.extend((part.len() as u32).to_le_bytes());
        body.extend([0; 4]);
        body.extend(packed);
        let container = object(10, &body);
        let padding = container.len() % 4;
        bytes.extend(container);
        bytes.resize(bytes.len() + padding, 0);
    }
    bytes
}

/// A bag with a topic for each type; messages are the speed, and the torque in a second field where the bag defines the type.
pub(crate) fn bag(path: &Path, topics: &[(&str, &str)], is_defined: bool) {
    let mut bag = rusqlite::Connection::open(path).unwrap();
    bag.execute_batch(
        "CREATE TABLE topics (id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL);
         CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);",
    )
    .unwrap();
    let filling = bag.transaction().unwrap();
    if is_defined {
        filling
            .execute_batch(
                "CREATE TABLE message_definitions (id INTEGER PRIMARY KEY, topic_type TEXT, encoding TEXT, encoded_message_definition TEXT, type_description_hash TEXT);
                 INSERT INTO message_definitions VALUES (1, 'bench_msgs/msg/State', 'ros2msg', 'float64 speed_rad_s' || char(10) || 'float64 torque_Nm' || char(10), '');",
            )
            .unwrap();
    }
    for (index, (kind, name)) in (1_i64..).zip(topics) {
        filling.execute("INSERT INTO topics VALUES (?1, ?2, ?3, 'cdr')", (index, name, kind)).unwrap();
        for row in 0..ROWS {
            let mut data = vec![0, 1, 0, 0];
            data.extend(speed_rad_s(row).to_le_bytes());
            data.extend(torque_nm(row).to_le_bytes());
            let at = 1_700_000_000_000_000_000 + 1000 * time_us(row) as i64;
            filling
                .execute(
                    "INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)",
                    (index, at, data),
                )
                .unwrap();
        }
    }
    filling.commit().unwrap();
}
