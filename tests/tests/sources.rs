//! `record` of devices other than the own board, as a process: over loopback, and over pseudo-terminals in the place of serial lines.

use std::io::{Read, Write};
use std::net::{TcpListener, UdpSocket};
use std::path::Path;
use std::process::Stdio;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};
use socam_sources::simulators::{
    DynamixelSimulator, FeetechSimulator, Firmware, MoteusSimulator, Motor, OdriveSimulator,
};
use socam_tests::{Ending, path, record, run, socam_host};

/// Sends a line every 2 ms by the clock, until told to end.
fn send_evenly(is_over: &AtomicBool, mut send: impl FnMut(u64) -> std::io::Result<()>) {
    let begin = Instant::now();
    for k in 0.. {
        let due = begin + Duration::from_millis(2 * k);
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        if is_over.load(Ordering::Relaxed) || send(k).is_err() {
            return;
        }
    }
}

/// A device of TCP whose first connection ends within a line; what is lost, repeated and damaged is counted, and nothing else is.
#[test]
fn lost_repeated_and_damaged_lines_are_counted_and_a_link_that_breaks_is_taken_up_again() {
    let folder = tempfile::tempdir().unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let device = format!("text+tcp:{}", listener.local_addr().unwrap());
    let log = path(&folder, "run.mcap");
    let is_over = AtomicBool::new(false);
    let ran = std::thread::scope(|scope| {
        let _ending = Ending(&is_over);
        scope.spawn(|| {
            let (mut first, _) = listener.accept().unwrap();
            first.write_all(b"t_us,seq,motor_speed_rad_s,torque_Nm\n").unwrap();
            let begin = Instant::now();
            let line = |k: u64| format!("{},{k},{},0.25\n", 2000 * k, 0.5 * k as f64);
            send_evenly(&is_over, |k| {
                match k {
                    // Three are lost, one comes twice, one is damaged.
                    1000..1003 => Ok(()),
                    1100 => first.write_all(line(k).repeat(2).as_bytes()),
                    1200 => first.write_all(b"2400000,1200,600,0.2x5\n"),
                    1300.. => Err(std::io::ErrorKind::BrokenPipe.into()),
                    _ => first.write_all(line(k).as_bytes()),
                }
            });
            first.write_all(b"2600000,1300,650.0,0.").unwrap();
            drop(first);
            let (mut second, _) = listener.accept().unwrap();
            let now = || begin.elapsed().as_millis() as u64 / 2;
            let start = now();
            send_evenly(&is_over, |k| second.write_all(line(start + k).as_bytes()));
        });
        record(&device, &log, &["--duration", "4s"])
    });
    let document = ran.document();
    assert_eq!(ran.code, Some(3), "{ran:?}");
    assert_eq!(
        (&document["repeated"], &document["late"], &document["clock_jumps"]),
        (&1.into(), &0.into(), &0.into())
    );
    assert_eq!((&document["damaged"], &document["interruptions"]), (&2.into(), &1.into()), "{ran:?}");
    let [samples, lost] = ["samples", "lost"].map(|key| document[key].as_u64().unwrap());
    // 4 s at 500 Hz are there or known to be missing: three, one damaged, and those while the link was gone.
    assert!((1999..=2001).contains(&(samples + lost)) && lost >= 4, "{samples} {lost}");
    let drift = document["clock"]["drift_1"].as_f64().unwrap();
    assert!(drift.abs() < 0.05, "{drift}");
    // No sample is wrong: the speed is that of its time.
    let data = socam_recording::Dataset::open(&log).unwrap().load(&["motor_speed", "torque"]).unwrap();
    let [speed, torque] = [0, 1].map(|column: usize| data.columns[column].values());
    assert!(torque.iter().all(|torque| *torque == 0.25));
    for (time_s, speed) in data.time_s.iter().zip(speed) {
        let expected = speed_0(&data) + 250.0 * time_s;
        assert!((speed - expected).abs() < 1e-6, "{time_s} {speed} {expected}");
    }
}

/// Speed at time 0: lines before the first recorded one may be missed at the start.
fn speed_0(data: &socam_recording::Loaded) -> f64 {
    data.columns[0].values()[0] - 250.0 * data.time_s[0]
}

/// What a device does not state is asked once: the file is written with question marks, completed, and used.
#[test]
fn what_a_device_does_not_state_is_asked_once_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let (log, file) = (path(&folder, "run.mcap"), path(&folder, "device.toml"));
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let device = format!("udp:{port}");
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let _ending = Ending(&is_over);
        scope.spawn(|| {
            // Nobody listens between the commands, which is no reason to end.
            let packet = |k: u64| {
                format!("{{\"timestamp\":{},\"motor\":{{\"speed\":{k},\"x\":1}}}}", 0.002 * k as f64)
            };
            send_evenly(&is_over, |k| {
                let _ = sender.send_to(packet(k).as_bytes(), port);
                Ok(())
            });
        });
        let asked = record(&device, &log, &["--describe", &file]);
        assert_eq!(asked.code, Some(1));
        assert!(
            asked
                .stderr
                .contains("does not state the unit of `motor.speed`, the unit of `motor.x`: replace each"),
            "{asked:?}"
        );
        assert!(!Path::new(&log).exists());
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("perhaps \"rpm\""), "{text}");
        let complete =
            text.replacen("unit = \"?\"", "unit = \"rpm\"", 1).replace("unit = \"?\"", "unit = \"V\"");
        std::fs::write(&file, complete).unwrap();
        let ran = record(&device, &log, &["--describe", &file, "--duration", "1s"]);
        let document = ran.document();
        assert_eq!(document["end"], "finished", "{ran:?}");
        assert_eq!(document["samples"].as_u64().unwrap() + document["lost"].as_u64().unwrap(), 500);
        // A clock in another unit than the file says is noticed before anything is recorded.
        let lying = std::fs::read_to_string(&file).unwrap().replace("unit = \"s\"", "unit = \"ms\"");
        std::fs::write(&file, lying).unwrap();
        let refused = record(&device, &path(&folder, "lie.mcap"), &["--describe", &file]);
        assert!(refused.refusal(1).contains("the device's clock `timestamp` runs "), "{refused:?}");
    });
    let info = run(["info", "--json", &log]).stdout;
    assert!(info.contains("device.toml") && info.contains("motor_speed"), "{info}");
}

/// The recorder's promise holds for every device: killed, it leaves all but the last second.
#[test]
fn a_killed_recorder_leaves_the_samples_of_a_device() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let is_over = AtomicBool::new(false);
    let mut command = socam_host();
    command.args(["record", "-o", &log, "--device", &format!("udp:{port}")]);
    let mut recorder = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    std::thread::scope(|scope| {
        let _ending = Ending(&is_over);
        scope.spawn(|| {
            let packet = |k: u64| format!("t_us:{},speed_rad_s:{k}", 2000 * k);
            send_evenly(&is_over, |k| {
                let _ = sender.send_to(packet(k).as_bytes(), port);
                Ok(())
            });
        });
        let begin = Instant::now();
        while !Path::new(&log).exists() && begin.elapsed() < Duration::from_secs(20) {
            std::thread::sleep(Duration::from_millis(20));
        }
        std::thread::sleep(Duration::from_millis(1500));
        let _ = recorder.kill();
    });
    let _ = recorder.wait();
    let data = socam_recording::Dataset::open(&log).unwrap();
    // 1.5 s were listened to before the file was there, and are in it.
    assert!(data.rows() > 1000 && data.lost_samples() == 0, "{} {}", data.rows(), data.lost_samples());
}

/// Devices that send nonsense: one sentence each, no panic, no file.
#[test]
fn hostile_devices_are_refused_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let endless = |line: &[u8]| line.repeat(1 + (1 << 16) / line.len());
    let noise: Vec<u8> =
        (0..1_u32 << 16).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8 | 0x80).collect();
    let devices: [(&str, Vec<u8>, &str); 8] = [
        ("noise", noise, "none of the"),
        ("utf-16", "1,2\n3,4\n5,6\n".encode_utf16().flat_map(u16::to_be_bytes).collect(), "none of the"),
        ("no line", b"1".repeat(1 << 18), "none of the"),
        ("words", endless(b"hello world\n"), "none of the"),
        ("nothing but missing", endless(b"nan,nan\n"), "none of the"),
        ("broken JSON", endless(b"{\"a\": \n"), "none of the"),
        ("numbers beyond all", endless(b"1e999,1e999\n"), "none of the"),
        ("no names", endless(b"0.5 1.5\n"), "does not state the unit of `column 1`"),
    ];
    std::thread::scope(|scope| {
        for (name, bytes, sentence) in &devices {
            let log = path(&folder, &format!("{name}.mcap"));
            scope.spawn(move || {
                let listener = TcpListener::bind("127.0.0.1:0").unwrap();
                let device = format!("text+tcp:{}", listener.local_addr().unwrap());
                std::thread::scope(|scope| {
                    scope.spawn(|| {
                        let (mut link, _) = listener.accept().unwrap();
                        let _ = link.write_all(bytes);
                        // It stays connected until it is given up.
                        let _ = link.read(&mut [0]);
                    });
                    let ran = record(&device, &log, &[]);
                    assert!(ran.refusal(1).contains(sentence), "{name}: {ran:?}");
                    assert!(!Path::new(&log).exists(), "{name}");
                });
            });
        }
    });
}

/// A drive on a pseudo-terminal, in the place of its serial line.
fn drive(is_over: &AtomicBool, mut line: TTYPort, mut answer: impl FnMut(f64, &[u8]) -> Vec<u8>) {
    let begin = Instant::now();
    line.set_timeout(Duration::from_millis(5)).unwrap();
    let mut bytes = [0; 4096];
    while !is_over.load(Ordering::Relaxed) {
        if let Ok(count) = line.read(&mut bytes) {
            let answer = answer(begin.elapsed().as_secs_f64(), &bytes[..count]);
            let _ = line.write_all(&answer);
        }
    }
}

#[test]
fn drives_are_asked_at_a_rate_and_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let motor = Motor::turning(12.5, 0.25, 24.0);
    for kind in ["moteus", "odrive", "dynamixel"] {
        let (ours, theirs) = TTYPort::pair().unwrap();
        let device = format!("{kind}:{}", theirs.name().unwrap());
        let is_over = AtomicBool::new(false);
        let log = path(&folder, &format!("{kind}.mcap"));
        let ran = std::thread::scope(|scope| {
            let _ending = Ending(&is_over);
            scope.spawn(|| {
                let (mut moteus, mut odrive) =
                    (MoteusSimulator::new(1, motor), OdriveSimulator::new(Firmware::Late, motor));
                let mut dynamixel = DynamixelSimulator::new(1, 1020, motor);
                drive(&is_over, ours, |time_s, bytes| match kind {
                    "moteus" => moteus.receive(time_s, bytes),
                    "dynamixel" => dynamixel.receive(time_s, bytes),
                    _ => odrive.receive(time_s, bytes),
                });
            });
            record(&device, &log, &["--duration", "1s", "--rate", "200"])
        });
        let document = ran.document();
        assert_eq!(document["damaged"], 0, "{ran:?}");
        assert!((150..=201).contains(&document["samples"].as_u64().unwrap()), "{ran:?}");
        let data = socam_recording::Dataset::open(&log).unwrap().load(&["speed", "voltage"]).unwrap();
        assert!(data.columns[0].values().iter().all(|speed| (speed - 12.5).abs() < 0.013));
        assert!(data.columns[1].values().iter().all(|voltage| *voltage == 24.0));
    }
}

/// Servos of one bus whose cable is pulled for a second: one row has the values of all, and the recording goes on.
#[test]
fn servos_of_one_bus_are_recorded_together_and_after_their_cable_was_pulled() {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["dynamixel", "feetech"] {
        let (ours, theirs) = TTYPort::pair().unwrap();
        let device = format!("{kind}:{}?id=1,2,5", theirs.name().unwrap());
        let log = path(&folder, &format!("{kind}.mcap"));
        let is_over = AtomicBool::new(false);
        let ran = std::thread::scope(|scope| {
            let _ending = Ending(&is_over);
            scope.spawn(|| {
                let motor = |id: u8| Motor::turning(f64::from(id), 0.25, 12.0);
                let mut dynamixels = [1, 2, 5].map(|id| DynamixelSimulator::new(id, 1020, motor(id)));
                let mut feetechs = [1, 2, 5].map(|id| FeetechSimulator::new(id, motor(id)));
                drive(&is_over, ours, |time_s, bytes| match kind {
                    _ if (1.5..2.5).contains(&time_s) => Vec::new(),
                    "dynamixel" => dynamixels.iter_mut().flat_map(|one| one.receive(time_s, bytes)).collect(),
                    _ => feetechs.iter_mut().flat_map(|one| one.receive(time_s, bytes)).collect(),
                });
            });
            record(&device, &log, &["--duration", "3s", "--rate", "200"])
        });
        let document = ran.document();
        assert_eq!((ran.code, &document["end"]), (Some(3), &"finished".into()), "{ran:?}");
        // A question to three servos waits 70 ms for its answers.
        let [samples, lost] = ["samples", "lost"].map(|key| document[key].as_u64().unwrap());
        assert!((300..=401).contains(&samples) && (10..=15).contains(&lost), "{ran:?}");
        let names = ["servo1_speed", "servo2_speed", "servo5_speed"];
        let data = socam_recording::Dataset::open(&log).unwrap().load(&names).unwrap();
        for (column, speed_rad_s) in [1.0, 2.0, 5.0].into_iter().enumerate() {
            assert!(data.columns[column].values().iter().all(|speed| (speed - speed_rad_s).abs() < 0.02));
        }
        let info = run(["info", "--json", &log]).stdout;
        assert!(info.contains("its homing offset is 0"), "{info}");
    }
}

/// A bus whose speed comes every 4 ms and whose torque every 10 ms.
#[cfg(feature = "full")]
#[test]
fn a_can_bus_is_listened_to_and_recorded_by_its_dbc() {
    let folder = tempfile::tempdir().unwrap();
    let (log, dbc) = (path(&folder, "run.mcap"), path(&folder, "bus.dbc"));
    std::fs::write(
        &dbc,
        "VERSION \"\"\n\nBU_: A\n\nBO_ 257 Motor: 2 A\n SG_ motor_speed : 0|16@1- (0.01,0) [0|0] \"rad/s\" A\n\n\
         BO_ 258 Load: 2 A\n SG_ torque : 0|16@1- (0.01,0) [0|0] \"Nm\" A\n",
    )
    .unwrap();
    let (mut ours, theirs) = TTYPort::pair().unwrap();
    let device = format!("slcan:{}?bitrate=500k", theirs.name().unwrap());
    let is_over = AtomicBool::new(false);
    let commands = std::sync::Mutex::new(Vec::new());
    let ran = std::thread::scope(|scope| {
        let _ending = Ending(&is_over);
        scope.spawn(|| {
            let mut adapter = socam_sources::simulators::SlcanSimulator::new(true);
            ours.set_timeout(Duration::from_millis(1)).unwrap();
            send_evenly(&is_over, |k| {
                let mut bytes = [0; 100];
                let count = ours.read(&mut bytes).unwrap_or(0);
                let mut said = adapter.receive(&bytes[..count]);
                let number = (k as i16).to_le_bytes();
                if k % 2 == 0 {
                    said.extend(adapter.frame(0.002 * k as f64, 257, &number));
                }
                if k % 5 == 0 {
                    said.extend(adapter.frame(0.002 * k as f64, 258, &number));
                }
                commands.lock().unwrap().clone_from(&adapter.commands);
                ours.write_all(&said)
            });
        });
        record(&device, &log, &["--dbc", &dbc, "--duration", "3s"])
    });
    let document = ran.document();
    assert_eq!((&document["end"], &document["damaged"]), (&"finished".into(), &0.into()), "{ran:?}");
    let drift = document["clock"]["drift_1"].as_f64().unwrap();
    assert!(drift.abs() < 0.05 && ran.stderr.contains("each frame of `Motor` gives a row"), "{ran:?}");
    let data = socam_recording::Dataset::open(&log).unwrap().load(&["motor_speed", "torque"]).unwrap();
    assert!((740..=750).contains(&data.time_s.len()), "{}", data.time_s.len());
    let [speed, torque] = [0, 1].map(|column: usize| data.columns[column].values());
    // Both rise alike; between the frames of the torque it is interpolated.
    let known = speed.iter().zip(torque).filter(|(_, torque)| !torque.is_nan());
    assert!(
        known.clone().count() > 700
            && known.into_iter().all(|(speed, torque)| (speed - torque).abs() < 0.011)
    );
    let sent = commands.lock().unwrap().clone();
    assert!(
        sent.iter().all(|command| ["", "C", "S6", "Z1", "L", "F"].contains(&command.as_str())),
        "{sent:?}"
    );
    let refused = record("udp:127.0.0.1:9", &path(&folder, "x.mcap"), &["--dbc", &dbc]);
    assert!(refused.refusal(2).contains("--dbc says what the frames of a CAN bus hold"), "{refused:?}");
}

#[test]
fn what_only_a_board_understands_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = record("udp:127.0.0.1:9", &path(&folder, "x.mcap"), &["--profile", "steps"]);
    assert!(
        refused.refusal(2).contains("a profile commands a board, a virtual bench or a drive"),
        "{refused:?}"
    );
    assert_eq!(run(["devices", "--json"]).json()["schema"], "socam.devices/1");
}
