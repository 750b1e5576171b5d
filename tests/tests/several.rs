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
    assert_eq!(metadata["device_channels"], "tcp_speed, torque; udp_speed");
    let refused = run(["align", &log, "--by", "tcp_speed=torque"]);
    assert!(refused.refusal(2).contains("tcp_speed is in rad/s and torque is in N m"), "{refused:?}");
    // A speed that rises evenly all the time determines no shift: an offset explains it as well.
    let refused = run(["align", &log, "--by", "tcp_speed=udp_speed"]);
    assert!(refused.refusal(1).contains("udp_speed is not laid over tcp_speed: "), "{refused:?}");
}

/// A motion that is like itself at no other time.
fn motion(t: f64) -> f64 {
    (2.0 * t + 0.4 * t * t).sin() + 0.5 * (7.3 * t + 1.0).sin()
}

/// A load behind a gear of -8 whose device is 3.7 ms late, at rows of 2 ms: the shift is found within its interval, and the new recording has
/// the load's channels at their right times.
#[test]
fn channels_of_a_device_are_shifted_by_a_motion_that_two_devices_saw() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (log, aligned) = (path("run.csv"), path("aligned.mcap"));
    let row = |k: u32| {
        let t = 0.002 * f64::from(k);
        // An error of the last digit, alike at no two rows.
        let noise = 1e-3 * f64::from(k.wrapping_mul(2_654_435_761) >> 16) / 65536.0;
        let late = motion(t - 0.0037);
        format!("{t:.3},{:.6},{:.6},{:.6}\n", -8.0 * motion(t) + noise, late + noise, 3.0 * late)
    };
    let rows: String = (0..4000).map(row).collect();
    std::fs::write(&log, format!("t_s,motor_speed_rad_s,load_speed_rad_s,load_torque_Nm\n{rows}")).unwrap();
    let arguments =
        ["align", &log, "--by", "motor_speed=load_speed", "--with", "load_torque", "-o", &aligned];
    let found = run(arguments.iter().chain(&["--json"])).json();
    let number = |name: &str| found[name]["value"].as_f64().unwrap();
    let ends: Vec<f64> =
        found["shift_s"]["ci95"].as_array().unwrap().iter().filter_map(serde_json::Value::as_f64).collect();
    assert!((number("shift_s") + 0.0037).abs() < 5e-5 && (number("gain") + 8.0).abs() < 0.01, "{found}");
    assert!(ends[1] - ends[0] < 1e-4 && ends[0] < -0.0036 && ends[1] > -0.0038, "{found}");
    let data = Dataset::open(&aligned).unwrap();
    let loaded = data.load(&["load_torque"]).unwrap();
    let torque = loaded.columns[0].values();
    let known = loaded.time_s.iter().zip(torque).filter(|(_, torque)| torque.is_finite());
    assert!(known.clone().count() >= 3997, "{}", known.count());
    assert!(known.into_iter().all(|(t, torque)| (torque - 3.0 * motion(*t)).abs() < 5e-3));
    let metadata = &data.contents().unwrap().metadata;
    assert!(metadata["aligned"].starts_with("load_speed is shifted by -3.70"), "{metadata:?}");

    // The same motion again and again: the shifts are offered, and one of them can be named.
    let periodic = path("periodic.csv");
    let row = |k: u32| {
        let t = 0.002 * f64::from(k);
        format!("{t:.3},{:.6},{:.6}\n", (31.0 * t).sin(), (31.0 * (t - 0.0037)).sin())
    };
    let rows: String = (0..4000).map(row).collect();
    std::fs::write(&periodic, format!("t_s,motor_speed_rad_s,load_speed_rad_s\n{rows}")).unwrap();
    let by = ["align", &periodic, "--by", "motor_speed=load_speed"];
    let refused = run(by);
    assert!(
        refused.refusal(1).contains("these shifts fit alike: -0.0037 s, +0.1990 s, -0.2064 s"),
        "{refused:?}"
    );
    let near = run(by.iter().chain(&["--near", "0.199", "--within", "0.05", "--json"])).json();
    assert!((near["shift_s"]["value"].as_f64().unwrap() - 0.19898).abs() < 1e-4, "{near}");
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
