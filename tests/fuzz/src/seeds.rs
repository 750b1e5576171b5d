//! Whole inputs of each parser, made by the project's own writers or taken from its own files.

mod foreign;
mod robots;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use socam_core::{Command, Config, Layout, Profile, Request, Ring, Sample, Shape};
use socam_recording::{
    Attachment, Calibration, Channel, Event, ProfileFile, Recorder, RecordingHeader, SampleRow, Status, Unit,
};
use socam_wire::{
    BoardKind, BoardLink, EnableFeedback, Encoder, FrontEnd, Identity, Image, MAX_FRAME, Start, Text,
    ToBoard, ToHost,
};

pub(crate) use foreign::{foreign, foreign_tables, mappings};
pub(crate) use robots::{DBC, databases};

/// The repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// All files of a folder of the repository with this extension.
fn files(folder: &str, extension: &str) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(root().join(folder)).into_iter().flatten().flatten();
    let paths = entries.map(|entry| entry.path());
    let mut paths: Vec<PathBuf> =
        paths.filter(|path| path.extension().is_some_and(|e| e == extension)).collect();
    paths.sort();
    paths.iter().filter_map(|path| std::fs::read(path).ok()).collect()
}

fn texts<const N: usize>(all: [&str; N]) -> Vec<Vec<u8>> {
    all.map(|text| text.as_bytes().to_vec()).to_vec()
}

/// Two recordings, and each as another program would write it: without compression and checksums, so that damage reaches the messages.
pub(crate) fn logs(folder: &Path) -> Vec<Vec<u8>> {
    let mut all = Vec::new();
    for rows in [0, 40, 600] {
        let path = folder.join(format!("seed-{rows}.mcap"));
        if record(&path, rows).is_some() {
            all.extend(std::fs::read(&path));
        }
    }
    let plain: Vec<Vec<u8>> = all.iter().filter_map(|log| without_checksums(log)).collect();
    all.extend(plain);
    all
}

/// A recording of this many samples. The speed of a sample is a quarter of its number.
pub(crate) fn record(path: &Path, rows: i64) -> Option<()> {
    let channels = vec![Channel::new("motor_speed", Unit::RadPerS), Channel::new("torque_in", Unit::Nm)];
    let attachment = Attachment {
        name: "model.toml".into(),
        media_type: "application/toml".into(),
        data: b"[model]".to_vec(),
    };
    let header = RecordingHeader {
        start_unix_ns: 1_700_000_000_000_000_000,
        metadata: BTreeMap::from([("note".into(), "seed".into())]),
        attachments: vec![attachment],
        planned_duration_s: Some(1.0),
        ..RecordingHeader::new(channels)
    };
    let mut recorder = Recorder::create(path, &header).ok()?;
    for index in 0..rows {
        // A gap in the middle.
        let sequence = index as u64 + if index > rows / 2 { 3 } else { 0 };
        recorder.push_samples(&[SampleRow {
            device_time_ns: sequence as i64 * 1_000_000,
            sequence,
            flags: 0,
            raw_counts: &[-5, 1000],
            values: &[index as f64 * 0.25, if index % 10 == 3 { f64::NAN } else { -1.5 }],
        }]);
    }
    recorder.status(&Status {
        device_time_ns: 1,
        state: "running".into(),
        overruns: 1,
        lost: 0,
        link_errors: 2,
    });
    recorder.event(&Event { device_time_ns: 7, kind: "stop".into(), text: "done".into() });
    recorder.finish().ok().map(|_| ())
}

fn without_checksums(log: &[u8]) -> Option<Vec<u8>> {
    let mut copy = std::io::Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().compression(None).calculate_chunk_crcs(false);
    let mut writer = options.calculate_data_section_crc(false).create(&mut copy).ok()?;
    for message in mcap::MessageStream::new(log).ok()? {
        writer.write(&message.ok()?).ok()?;
    }
    writer.finish().ok()?;
    drop(writer);
    Some(copy.into_inner())
}

/// Recordings as CSV.
pub(crate) fn tables(_: &Path) -> Vec<Vec<u8>> {
    let long: String = (0..200).map(|k| format!("{},{},{}\n", 0.001 * f64::from(k), k % 7, k * k)).collect();
    let mut all = texts([
        "t_s,motor_speed_rad_s,torque_in_Nm\n0,1,2\n0.001,1.5,\n0.002,,-3e2\n",
        "t_s,a_rad,b\r\n-1,+0.5,7\r\n\r\n0,1e-3,8\r\n",
        "t_s,\"a, quoted_rad\"\n0,1\n1,2\n3,4\n",
    ]);
    all.push(format!("t_s,a_rad,b_Nm\n{long}").into_bytes());
    all
}

/// Tables of operating points.
pub(crate) fn steady_states(_: &Path) -> Vec<Vec<u8>> {
    texts([
        "point_1,motor_speed_rad_s,torque_in_Nm\n1,10,0.5\n2,20,0.7\n3,30,\n",
        "point_1,torque_in_Nm,torque_out_Nm,note\n0.5,1,9.5,a\n1,2,19.1,b\n",
    ])
}

/// Logs of the thesis' program.
pub(crate) fn legacy_logs(_: &Path) -> Vec<Vec<u8>> {
    texts([
        "samprate=0.01;\namplitude=1.5;\ndata=[\n0.1 0.2 0.3 0.4 1.5\n0.1 0.2 0.3 0.4 1.5\n];\n",
        "% a comment\nsamprate=200\nfrequency=2;\noffset=-1e-3;\ndata={0.1,0.2,0.3,0.4,1.5;0.1,0.2,0.3,0.4,1.5\n1 2 3 4 5};\n",
    ])
}

/// Tables of calibration.
pub(crate) fn pairs(_: &Path) -> Vec<Vec<u8>> {
    texts([
        "applied_Nm,read_V\n0,0.01\n1,0.52\n2,1.03\n3,1.49\n",
        "# known torques\nreference_rad_s,read_V,std_V\n-10,-1,0.01\n0,0,0.01\n10,1.01,0.01\n",
    ])
}

/// Brackets that are closed by those of another kind: without a limit the parser recurses at each.
fn open_brackets() -> Vec<u8> {
    "a = { b = 95t\"\n[c]\n".repeat(20_000).into_bytes()
}

/// The models of the repository.
pub(crate) fn models(_: &Path) -> Vec<Vec<u8>> {
    let mut all = files("crates/socam-model/src/builtin", "toml");
    all.extend(files("tests/models", "toml"));
    all.extend(files("crates/socam-model/tests", "toml"));
    all.push(open_brackets());
    all
}

/// The built-in profiles.
pub(crate) fn profiles(_: &Path) -> Vec<Vec<u8>> {
    let names = ProfileFile::built_in_names();
    let texts = names.filter_map(|name| ProfileFile::text_of(name).ok()).map(String::into_bytes);
    texts.chain([open_brackets()]).collect()
}

/// The built-in calibration.
pub(crate) fn calibrations(_: &Path) -> Vec<Vec<u8>> {
    vec![Calibration::default_text().as_bytes().to_vec()]
}

/// Documents of the dashboard.
pub(crate) fn reports(folder: &Path) -> Vec<Vec<u8>> {
    let mut all = models(folder);
    all.extend(profiles(folder));
    all
}

/// A board's identity.
pub(crate) fn identity() -> Identity {
    let front_end = FrontEnd {
        kind: BoardKind::Analog,
        input_full_scale_uv: 10_240_000,
        output_full_scale_uv: 10_000_000,
        channel_step_ns: 3500,
    };
    Identity {
        board: Text::new("bench 7"),
        firmware: Text::new("0.1.0"),
        front_end,
        start: Start::Watchdog,
        enable_feedback: EnableFeedback::Pin,
        image: Image::Whole,
    }
}

fn frames<M: serde::Serialize>(messages: &[M]) -> Vec<u8> {
    let mut encoder = Encoder::new();
    let mut all = Vec::new();
    for message in messages {
        let mut out = [0; MAX_FRAME];
        let length = encoder.encode(message, &mut out).unwrap_or(0);
        all.extend_from_slice(&out[..length]);
    }
    all
}

/// What a board sends.
pub(crate) fn to_host(_: &Path) -> Vec<Vec<u8>> {
    let mut ring = Ring::<i32, 32>::new();
    let (mut producer, consumer) = ring.split();
    for number in 0..20_u32 {
        let counts = [number as i32; socam_core::MAX_CHANNELS];
        producer.push(&Sample { tick: 5 * number, seq: number, counts, ..Sample::default() });
    }
    let mut link = BoardLink::new(identity(), consumer);
    let mut out = [0; MAX_FRAME];
    let mut samples = Vec::new();
    while let Some(length) = link.samples(Layout::try_from([4, 2]).unwrap_or(Layout::narrow(4)), 1, &mut out)
    {
        samples.extend_from_slice(&out[..length]);
    }
    let answer = |number| ToHost::Answer { number, result: Ok(()) };
    let mut all = frames(&[ToHost::Hello(identity()), answer(1)]);
    all.extend_from_slice(&samples);
    vec![all, samples, frames(&[answer(2), answer(3), answer(3), answer(u16::MAX)])]
}

/// What a host sends.
pub(crate) fn to_board(_: &Path) -> Vec<Vec<u8>> {
    let profile = Profile {
        command: Command::Voltage,
        shape: Shape::Constant { level_micro: 1_000_000 },
        ramp_us: 1000,
        limit_micro: 2_000_000,
        slew_micro_s: 10_000_000,
        duration_us: 5_000_000,
    };
    let requests = [
        Request::Configure(Config::default()),
        Request::Load(profile),
        Request::Arm,
        Request::Stream(true),
        Request::Run,
        Request::Heartbeat,
        Request::Stop,
        Request::EmergencyStop,
        Request::ClearFault,
    ];
    let all: Vec<ToBoard> = std::iter::once(ToBoard::Hello)
        .chain((0_u16..).zip(requests).map(|(number, request)| ToBoard::Request { number, request }))
        .collect();
    vec![frames(&all), frames(&all[..2])]
}
