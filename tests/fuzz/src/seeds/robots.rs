//! Logs of robots, vehicles and buses, byte by byte after their public descriptions.

use std::path::Path;

const ROWS: u64 = 12;

/// What the frames of the logs of a bus hold.
pub(crate) const DBC: &str = "VERSION \"\"\n\nBU_: Motor\n\nBO_ 257 Drive: 8 Motor\n SG_ speed : 0|16@1- (0.5,10) [0|0] \"rpm\" Motor\n \
     SG_ page M : 23|8@0+ (1,0) [0|0] \"\" Motor\n SG_ torque m1 : 24|32@1- (1,0) [0|0] \"Nm\" Motor\n\nSIG_VALTYPE_ 257 torque : 1;\n";

/// A frame's data, in two pages.
fn frame(row: u64) -> [u8; 8] {
    let torque = (row as f32).to_le_bytes();
    [row as u8, 0, (row % 2) as u8, torque[0], torque[1], torque[2], torque[3], 0]
}

fn hex(row: u64, between: &str) -> String {
    frame(row).map(|byte| format!("{byte:02X}")).join(between)
}

pub(super) fn binary(folder: &Path) -> [Option<Vec<u8>>; 4] {
    [Some(wpilog()), Some(ulog()), Some(blf()), bag(folder)]
}

/// Logs of a bus in text.
pub(super) fn text() -> [String; 3] {
    let rows = |line: &dyn Fn(u64) -> String| (0..ROWS).map(|row| line(row) + "\n").collect::<String>();
    [
        rows(&|row| format!("({row}.5) can0 101#{}", hex(row, ""))),
        rows(&|row| format!(" ({row}.5)  can0  101   [8]  {}", hex(row, " "))),
        "base hex  timestamps absolute\n".to_owned()
            + &rows(&|row| format!("{row}.5 1 101 Rx d 8 {}", hex(row, " "))),
    ]
}

/// DBC, each of which may be beside such a log.
pub(crate) fn databases(_: &Path) -> Vec<Vec<u8>> {
    let extended = DBC.replace("m1 :", "m1M :") + "SG_MUL_VAL_ 257 torque page 1-1, 3-5;\n";
    super::texts([DBC, &extended])
}

fn wpilog() -> Vec<u8> {
    let record = |id: u8, time: u64, payload: &[u8]| {
        [&[0b0111_0000, id, payload.len() as u8], time.to_le_bytes().as_slice(), payload].concat()
    };
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let start = |id: u8, name: &str, kind: &str, metadata: &str| {
        record(0, 0, &[&[0, id, 0, 0, 0], text(name).as_slice(), &text(kind), &text(metadata)].concat())
    };
    let mut bytes = b"WPILOG\x00\x01\x00\x00\x00\x00".to_vec();
    bytes.extend(start(1, "speed_rpm", "double", ""));
    bytes.extend(start(2, "phase", "float[]", "{\"unit\":\"A\"}"));
    bytes.extend(start(3, "sysid-test-state", "string", ""));
    for row in 0..ROWS {
        bytes.extend(record(1, 1000 * row, &(row as f64).to_le_bytes()));
        bytes.extend(record(2, 1000 * row, &[row as f32, 0.5].map(f32::to_le_bytes).concat()));
        bytes.extend(record(3, 1000 * row, b"dynamic-forward"));
    }
    bytes
}

fn ulog() -> Vec<u8> {
    let message = |kind: u8, payload: &[u8]| [&[payload.len() as u8, 0, kind], payload].concat();
    let mut bytes = b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0".to_vec();
    bytes.extend(message(b'B', &[0; 40]));
    bytes.extend(message(b'F', b"axis:int16_t speed_rpm;float[2] current;"));
    bytes.extend(message(b'F', b"drive:uint64_t timestamp;axis[2] axis;uint8_t[4] _padding0;"));
    bytes.extend(message(b'A', b"\x00\x00\x00drive"));
    for row in 0..ROWS {
        let axis = [&(row as u16).to_le_bytes(), [row as f32, 0.5].map(f32::to_le_bytes).concat().as_slice()]
            .concat();
        bytes.extend(message(b'D', &[&[0, 0], (1000 * row).to_le_bytes().as_slice(), &axis, &axis].concat()));
        bytes.extend(message(b'S', b"\x2f\x73\x13\x20\x25\x0c\xbb\x12"));
    }
    bytes
}

fn blf() -> Vec<u8> {
    let object = |kind: u32, body: &[u8]| {
        let words = [16 | 1 << 16, 16 + body.len() as u32, kind].map(u32::to_le_bytes).concat();
        [b"LOBJ".as_slice(), &words, body].concat()
    };
    let mut frames = Vec::new();
    for row in 0..ROWS {
        let head = [&[2, 0, 0, 0, 0, 0, 0, 0], (1_000_000 * row).to_le_bytes().as_slice()].concat();
        frames.extend(object(86, &[&head, [1, 0, 0, 8, 1, 1, 0, 0].as_slice(), &frame(row)].concat()));
    }
    let mut bytes = b"LOGG\x10\0\0\0".to_vec();
    bytes.resize(16, 0);
    bytes.extend(object(10, &[[0; 16].as_slice(), &frames].concat()));
    bytes
}

fn bag(folder: &Path) -> Option<Vec<u8>> {
    let path = folder.join("seed.db3");
    let bag = rusqlite::Connection::open(&path).ok()?;
    bag.execute_batch(
        "PRAGMA page_size = 512; PRAGMA journal_mode = OFF;
         CREATE TABLE topics (id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
         CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);
         CREATE TABLE message_definitions (topic_type TEXT, encoding TEXT, encoded_message_definition TEXT);
         INSERT INTO topics VALUES (1, '/speed_rpm', 'std_msgs/msg/Float64', 'cdr'), (2, '/state', 'a/msg/State', 'cdr');
         INSERT INTO message_definitions VALUES ('a/msg/State', 'ros2msg', 'float64[] speed_rpm');",
    )
    .ok()?;
    for row in 0..ROWS {
        let one = [&[0, 1, 0, 0], (row as f64).to_le_bytes().as_slice()].concat();
        let list = [&[0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0], (row as f64).to_le_bytes().as_slice()].concat();
        for (topic, data) in [(1, one), (2, list)] {
            let sql = "INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)";
            bag.execute(sql, (topic, 1_000_000 * row as i64, data)).ok()?;
        }
    }
    bag.close().ok()?;
    std::fs::read(path).ok()
}
