//! The same machine in other sizes: a joint that creeps, a drive of minutes, a watch's motor. No size is built into the answer.

use socam_diagnose::{HeldOut, Options, diagnose};
use socam_recording::Dataset;

// The truth of the other tests is not used.
#[allow(dead_code)]
mod motor;
use motor::{recording, sized};

const FRICTION: f64 = 0.2;

/// Factors on time, speed and torque.
const SIZES: [[f64; 3]; 4] = [[1.0, 1e-3, 1.0], [200.0, 5e-3, 1.0], [0.01, 1.0, 1e3], [1.0, 10.0, 1e-6]];

/// Samples that are used: enough, and fast.
const ROWS: usize = 1200;

fn resized(data: &Dataset, [time, speed, torque]: [f64; 3]) -> Dataset {
    let loaded = data.load(&["torque", "speed"]).unwrap();
    let times = loaded.time_s.iter().take(ROWS).map(|t| time * t).collect();
    let columns = loaded.columns.iter().zip([torque, speed]);
    let columns =
        columns.map(|(column, factor)| column.values().iter().take(ROWS).map(|v| factor * v).collect());
    Dataset::from_columns(data.name(), data.channels().to_vec(), times, columns.collect()).unwrap()
}

#[test]
fn friction_is_found_whatever_the_size_of_the_machine() {
    let data = recording(1, FRICTION);
    for size in SIZES {
        let answer =
            diagnose(&sized(size), &[resized(&data, size)], HeldOut::none(), &Options::default()).unwrap();
        let found: Vec<_> =
            answer.diagnosis.findings.iter().map(|own| (&*own.effect, &*own.location)).collect();
        assert_eq!(found, [("coulomb_friction", "bearing")], "{size:?}");
        let torque = answer.diagnosis.findings[0].parameters[0].value.unwrap() / size[2];
        assert!((torque / FRICTION - 1.0).abs() < 0.02, "{size:?}: {torque}");
    }
}
