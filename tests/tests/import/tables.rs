//! Tables of text as programs all over the world write them.

use std::path::Path;

use socam_tests::{path, run};

use super::columns;

/// Expected content of a file: times, and values of `speed` in rad/s.
struct Case {
    name: &'static str,
    content: &'static [u8],
    time_s: &'static [f64],
    speed: &'static [f64],
}

const CASES: [Case; 15] = [
    Case {
        name: "German.csv",
        content: b"Zeit [ms];speed [rad/s]\r\n0,0;1,5\r\n1,0;-2,5\r\n2,0;1.003,5\r\n",
        time_s: &[0.0, 0.001, 0.002],
        speed: &[1.5, -2.5, 1003.5],
    },
    Case {
        name: "units line.csv",
        content: b"t,speed\ns,rad/s\n0,1\n0.5,2\n1,3\n",
        time_s: &[0.0, 0.5, 1.0],
        speed: &[1.0, 2.0, 3.0],
    },
    Case {
        name: "preamble.txt",
        content: b"Bench 3\nOperator: A. B.\nDate: 1.5.2024\n\nTime (s)\tspeed (rad/s)\n0.1\t1\n0.2\t2\n0.3\tNaN\n0.4\t4\n",
        time_s: &[0.1, 0.2, 0.3, 0.4],
        speed: &[1.0, 2.0, f64::NAN, 4.0],
    },
    Case {
        name: "blanks.dat",
        content: b"# t_ms   speed_rad_s\n  0.0    1.0\n 10.0    2.0\n 20.0    3.0\n",
        time_s: &[0.0, 0.01, 0.02],
        speed: &[1.0, 2.0, 3.0],
    },
    Case {
        name: "dates.csv",
        content: b"timestamp,speed [rad/s]\n2024-05-01 12:00:00.000,1\n2024-05-01 12:00:00.250,2\n2024-05-01 12:00:00.500,3\n",
        time_s: &[0.0, 0.25, 0.5],
        speed: &[1.0, 2.0, 3.0],
    },
    Case {
        name: "quoted.csv",
        content: b"\"time [s]\",\"note, of the operator\",\"speed [rad/s]\"\n0,\"a, b\",1\n1,\"c\",2\n2,\"\",3\n",
        time_s: &[0.0, 1.0, 2.0],
        speed: &[1.0, 2.0, 3.0],
    },
    Case {
        name: "excel.csv",
        content: b"\xef\xbb\xbfsep=;\ntime [s];speed [rad/s];\n0;1;\n1;2;\n2;;\n3;4;\n",
        time_s: &[0.0, 1.0, 2.0, 3.0],
        speed: &[1.0, 2.0, f64::NAN, 4.0],
    },
    Case {
        name: "Latin.csv",
        // A micro sign and a degree sign of Western European encoding.
        content: b"Zeit [\xb5s];speed [rad/s];Temp [\xb0C]\n0;1;20\n500;2;20,5\n1000;3;21\n",
        time_s: &[0.0, 0.0005, 0.001],
        speed: &[1.0, 2.0, 3.0],
    },
    Case {
        name: "UTF-16.csv",
        content: b"\xff\xfet\0 \0[\0s\0]\0,\0s\0p\0e\0e\0d\0 \0[\0r\0a\0d\0/\0s\0]\0\n\x000\0,\x001\0\n\x001\0,\x002\0\n\x002\0,\x003\0\n\0",
        time_s: &[0.0, 1.0, 2.0],
        speed: &[1.0, 2.0, 3.0],
    },
    Case {
        name: "pipes.log",
        content: b"time_s|speed_rad_s|mode\n0.0|1|idle\n0.1|2|idle\n0.2|3|run\n",
        time_s: &[0.0, 0.1, 0.2],
        speed: &[1.0, 2.0, 3.0],
    },
    Case {
        name: "thousands.csv",
        content: b"t_s;speed_rad_s\n0.000;\"1,000.5\"\n0.001;2,001.5\n0.002;-2.5\n",
        time_s: &[0.0, 0.001, 0.002],
        speed: &[1000.5, 2001.5, -2.5],
    },
    Case {
        name: "Swiss.csv",
        content: b"t_s;speed_rad_s\n0.000;1'001.5\n0.001;2'001.25\n0.002;7\n",
        time_s: &[0.0, 0.001, 0.002],
        speed: &[1001.5, 2001.25, 7.0],
    },
    Case {
        name: "whole thousands.csv",
        content: b"t_s;speed_rad_s\n0,000;1.001\n0,001;2.001\n0,002;12.001\n",
        time_s: &[0.0, 0.001, 0.002],
        speed: &[1001.0, 2001.0, 12_001.0],
    },
    Case {
        name: "per second.csv",
        content: b"time_s,torque [Nm],speed_deg_per_s\n0,0,180\n1,0,360\n2,0,90\n",
        time_s: &[0.0, 1.0, 2.0],
        speed: &[std::f64::consts::PI, std::f64::consts::TAU, std::f64::consts::FRAC_PI_2],
    },
    Case {
        name: "socam without its order.csv",
        content: b"speed_rad_s,t_s\n1,0\n2,1\n3,2\n",
        time_s: &[0.0, 1.0, 2.0],
        speed: &[1.0, 2.0, 3.0],
    },
];

#[test]
fn tables_of_the_world_are_read_without_a_mapping() {
    let folder = tempfile::tempdir().unwrap();
    for Case { name, content, time_s, speed } in CASES {
        let (table, log) = (path(&folder, name), path(&folder, "run.mcap"));
        std::fs::write(&table, content).unwrap();
        let ran = run(["import", &table, "-o", &log, "--force"]);
        assert_eq!(ran.code, Some(0), "{name}: {}", ran.stderr);
        let [found_s, found] = columns(Path::new(&log), &["speed"]).try_into().unwrap();
        let is_near = |a: &f64, b: &f64| (a - b).abs() < 1e-9 || (a.is_nan() && b.is_nan());
        let is_equal =
            |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_near(a, b));
        assert!(is_equal(&found_s, time_s) && is_equal(&found, speed), "{name}: {found_s:?} {found:?}");
    }
}

/// A drive's log at 1 kHz and a load's at 100 Hz with its own clock, an encoder of 12 bits as the only sensor of the motor, a value
/// that marks missing samples, and a current that represents a torque.
#[test]
fn counts_rates_offsets_and_scales_are_what_the_mapping_says() {
    let folder = tempfile::tempdir().unwrap();
    let (table, map, log) =
        (path(&folder, "drive.csv"), path(&folder, "map.toml"), path(&folder, "run.mcap"));
    let angle = |t: f64| 40.0 * t + (5.0 * t).sin();
    let rows: String = (0..3000)
        .map(|k| {
            let t = 1e-3 * f64::from(k);
            let counts = (angle(t) / std::f64::consts::TAU * 4000.0).round().rem_euclid(4096.0);
            let current = if k == 77 { -9999.0 } else { 2.0 * t };
            format!("{},{counts},{current}\n", 1_700_000_000_000_000_i64 + i64::from(k) * 1000)
        })
        .collect();
    std::fs::write(&table, format!("time,encoder,current_mA\n{rows}")).unwrap();
    let proposed = run(["import", &table, "--propose"]);
    assert!(proposed.stderr.contains("counts, and they jump: wrap = 4096?"), "{}", proposed.stderr);
    assert!(proposed.stderr.contains("its size is that of microseconds since 1970"), "{}", proposed.stderr);
    let mapping = "[[clocks]]\ntime = \"time\"\nunit = \"us\"\n\
        [channels.motor_angle]\nsignal = \"encoder\"\nunit = \"counts\"\ncounts_per_turn = 4000\nwrap = 4096\n\
        [channels.torque]\nsignal = \"current_mA\"\nunit = \"mA\"\nscale = 0.055\nto = \"N m\"\nmissing = -9999\n";
    std::fs::write(&map, mapping).unwrap();
    let ran = run(["import", &table, "--map", &map, "-o", &log]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stderr.contains("continued at 18 wraps"), "{}", ran.stderr);
    let [time_s, turned, torque] = columns(Path::new(&log), &["motor_angle", "torque"]).try_into().unwrap();
    let step = std::f64::consts::TAU / 4000.0;
    let worst = time_s.iter().zip(&turned).map(|(t, found)| (found - angle(*t)).abs()).fold(0.0, f64::max);
    assert!(worst <= 0.51 * step, "{worst}");
    assert!(
        torque[77].is_nan() && (torque[1000] - 0.055 * 2e-3).abs() < 1e-12,
        "{} {}",
        torque[77],
        torque[1000]
    );
}
