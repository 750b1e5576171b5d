//! `record` of several devices into one recording, as a process.

use std::io::Write;
use std::net::{TcpListener, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use socam_recording::Dataset;
use socam_tests::{Ending, run};

/// Sends rows at an interval, with the number of each and its time since `begin`, until told to end.
fn send(begin: Instant, step: Duration, is_over: &AtomicBool, mut send: impl FnMut(u64, Duration) -> bool) {
    for number in 0.. {
        let due = begin + step * number as u32;
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        if is_over.load(Ordering::Relaxed) || !send(number, step * number as u32) {
            return;
        }
    }
}

/// A device at 500 Hz whose clock runs 300 ppm fast, and one at 250 Hz without a clock, both of which send the time at which a row was taken: in
/// each row they agree within what is stated.
#[test]
fn rows_of_two_devices_are_put_together_on_the_hosts_clock() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap").display().to_string();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let tcp = format!("text+tcp:{}", listener.local_addr().unwrap());
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let (udp, begin, is_over) = (format!("udp:{port}"), Instant::now(), AtomicBool::new(false));
    let ran = std::thread::scope(|scope| {
        let _ending = Ending(&is_over);
        scope.spawn(|| {
            let (mut line, _) = listener.accept().unwrap();
            line.write_all(b"t_us,seq,speed_rad_s,torque_Nm\n").unwrap();
            send(begin, Duration::from_millis(2), &is_over, |number, at| {
                let clock_us = (at.as_micros() as f64 * 1.0003) as u64;
                // Rows that were due before anybody listened are not sent.
                let is_late = begin.elapsed() > at + Duration::from_millis(50);
                let row = format!("{clock_us},{number},{},0.25\n", at.as_secs_f64());
                is_late || line.write_all(row.as_bytes()).is_ok()
            });
        });
        scope.spawn(|| {
            send(begin, Duration::from_millis(4), &is_over, |_, at| {
                let _ = sender.send_to(format!("{{\"speed_rad_s\":{}}}", at.as_secs_f64()).as_bytes(), port);
                true
            });
        });
        run(["record", "-o", &log, "--device", &udp, "--device", &tcp, "--duration", "4s", "--json"])
    });
    assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
    let document = ran.document();
    let device = |name: &str| {
        let mut devices = document["devices"].as_array().unwrap().iter();
        devices.find(|device| device["name"] == name).unwrap_or_else(|| panic!("{document}")).clone()
    };
    assert_eq!((&device("tcp")["has_clock"], &device("udp")["has_clock"]), (&true.into(), &false.into()));
    let data = Dataset::open(&log).unwrap();
    let names: Vec<&str> = data.channels().iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(names, ["tcp_speed", "torque", "udp_speed"], "the fastest device is the first one");
    let loaded = data.load(&["tcp_speed", "udp_speed"]).unwrap();
    let [tcp, udp] = [0, 1].map(|column: usize| loaded.columns[column].values());
    assert!((1990..=2001).contains(&tcp.len()), "{} rows in 4 s at 500 Hz", tcp.len());
    let differences: Vec<f64> =
        tcp.iter().zip(udp).map(|(tcp, udp)| (tcp - udp).abs()).filter(|d| d.is_finite()).collect();
    // Where this computer is so busy that a row arrives 10 ms late, its value is missing.
    assert!(differences.len() > 800, "values of the slower device are there: {}", differences.len());
    let mut sorted = differences.clone();
    sorted.sort_by(f64::total_cmp);
    let stated_s =
        ["tcp", "udp"].map(|name| device(name)["uncertainty_s"].as_f64().unwrap()).iter().sum::<f64>();
    let middle_s = sorted[sorted.len() / 2];
    assert!(middle_s < stated_s.max(0.002) && stated_s < 0.2, "{middle_s} s apart, {stated_s} s stated");
    println!(
        "measured: two devices agree within {:.3} ms in the middle, {:.3} ms at most; stated {:.3} ms",
        1e3 * middle_s,
        1e3 * sorted[sorted.len() - 1],
        1e3 * stated_s
    );
    let metadata = &data.contents().unwrap().metadata;
    assert!(
        metadata["device"].contains("udp:") && metadata["device"].contains("; text+tcp:"),
        "{metadata:?}"
    );
}

#[test]
fn what_commands_a_device_and_what_belongs_to_one_alone_is_refused_for_several() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap").display().to_string();
    let refused = |more: &[&str]| {
        let ran = run(["record", "-o", &log, "--device", "udp:127.0.0.1:1"].iter().chain(more));
        assert_eq!(ran.code, Some(2), "{ran:?}");
        ran.stderr
    };
    assert!(refused(&["--device", "sim"]).contains("record it by itself"));
    assert!(refused(&["--device", "udp:127.0.0.1:1"]).contains("named twice"));
    let moteus = ["--device", "moteus:/dev/none", "--profile", "steps", "--arm"];
    assert!(refused(&moteus).contains("only listened to or asked"));
    assert!(
        refused(&["--device", "udp:127.0.0.1:2", "--describe", "d.toml"])
            .contains("exactly one device among several")
    );
    assert!(refused(&["--device", "udp:127.0.0.1:2", "--dbc", "d.dbc"]).contains("exactly one CAN bus"));
}
