//! Segments and their chunks: no row is lost at a cut, and no input changes.

use socam_model::{ChannelTransform, Role};
use socam_recording::{Channel, Unit};

use super::*;

/// A dataset of the two-mass model's channels whose values encode their rows; some rows and some inputs are missing.
fn numbered(rows: u64, missing: impl Fn(u64) -> bool, blind: impl Fn(u64) -> bool) -> (Model, Dataset) {
    let model = Model::builtin("speed-o-cam").unwrap();
    let there: Vec<u64> = (0..rows).filter(|row| !missing(*row)).collect();
    let time_s = there.iter().map(|row| *row as f64 / 1000.0).collect();
    let units = [Unit::RadPerS, Unit::RadPerS, Unit::Nm, Unit::Nm];
    let names = ["motor_speed", "output_speed", "torque_in", "torque_out"];
    let channels = names.iter().zip(units).map(|(name, unit)| Channel::new(*name, unit)).collect();
    let value = |row: u64| ((row * row) % 1009) as f64;
    let input = there.iter().map(|row| if blind(*row) { f64::NAN } else { value(*row) }).collect();
    let output = |k: u64| there.iter().map(|row| (row * 4 + k) as f64).collect();
    let columns = vec![input, output(1), output(2), output(3)];
    (model, Dataset::from_columns("numbered", channels, time_s, columns).unwrap())
}

#[test]
fn speeds_and_waves_are_taken_of_an_angle() {
    let text = Model::builtin("two-mass").unwrap().text.replacen(
        "[channels.motor_torque]\nrole = \"input\"\nquantity = \"torque\"\nat = \"motor\"",
        "[channels.drive]\nrole = \"input\"\nquantity = \"speed\"\nat = \"motor\"\ncolumn = \"encoder_rad\"\n\
         take = \"rate\"\nscale = 2\n\
         [channels.wave]\nrole = \"input\"\nquantity = \"torque\"\nat = \"load\"\ncolumn = \"encoder_rad\"\n\
         take = { sin = 0.5 }\n[channels.other]\nrole = \"input\"\nquantity = \"torque\"\nat = \"load\"\n\
         column = \"encoder_rad\"\ntake = { cos = 3 }",
        1,
    );
    let model = Model::parse(&text).unwrap();
    let time_s: Vec<f64> = (0..9000).map(|row| f64::from(row) / 1000.0).collect();
    let angle = |t: f64| 1e4 + 300.0 * t + 0.02 * (200.0 * t).sin();
    let speed = |t: f64| 300.0 + 4.0 * (200.0 * t).cos();
    let names = [("encoder", Unit::Rad), ("motor_speed", Unit::RadPerS), ("load_speed", Unit::RadPerS)];
    let channels = names.iter().map(|(name, unit)| Channel::new(*name, *unit)).collect();
    let zero = vec![0.0; time_s.len()];
    let columns = vec![time_s.iter().map(|t| angle(*t)).collect(), zero.clone(), zero];
    let data = Dataset::from_columns("turning", channels, time_s.clone(), columns).unwrap();
    let parts = segments(&model, std::slice::from_ref(&data), 2500, &mut Vec::new()).unwrap();
    let mut row = 0;
    for part in &parts {
        read(&model, &data, part, &[Intersample::BandLimited; 3], |chunk| {
            for k in 0..chunk.rows() {
                let t = time_s[row];
                let tolerance = if (8..8992).contains(&row) { 1e-5 } else { 0.3 };
                assert!((chunk.inputs[0][k] - 2.0 * speed(t)).abs() < tolerance, "{row}");
                assert!((chunk.inputs[1][k] - (0.5 * angle(t)).sin()).abs() < 1e-9);
                assert!((chunk.inputs[2][k] - (3.0 * angle(t)).cos()).abs() < 1e-9);
                row += 1;
            }
        })
        .unwrap();
    }
    assert_eq!((row, parts.len()), (9000, 4));
}

fn read_all(model: &Model, data: &Dataset, segments: &[Segment], intersample: Intersample) -> [Vec<f64>; 3] {
    let mut all = [const { Vec::new() }; 3];
    for segment in segments {
        let before = all[0].len();
        read(model, data, segment, &[intersample], |chunk| {
            assert!(chunk.outputs.iter().all(|column| column.len() == chunk.rows()));
            let before = intersample::margin(intersample) + 1;
            assert_eq!(chunk.held[0].len(), chunk.rows() + 2 * before - 1);
            all[0].extend_from_slice(&chunk.inputs[0]);
            all[1].extend_from_slice(&chunk.held[0][before..before + chunk.rows()]);
            all[2].extend_from_slice(&chunk.outputs[1]);
        })
        .unwrap();
        assert_eq!((all[0].len() - before) as u64, segment.rows);
    }
    all
}

#[test]
fn cutting_loses_no_row_and_changes_no_input() {
    let (mut model, data) = numbered(20_000, |row| row == 12_000, |row| row == 15_000 || row == 15_005);
    let one = std::slice::from_ref(&data);
    let all = [
        (ChannelTransform::Value, Intersample::Linear),
        (ChannelTransform::Value, Intersample::BandLimited),
        (ChannelTransform::Rate, Intersample::BandLimited),
    ];
    for (take, intersample) in all {
        let input = model.channels.iter().position(|channel| channel.role == Role::Input).unwrap();
        model.channels[input].transform = take;
        let whole = segments(&model, one, u64::MAX, &mut Vec::new()).unwrap();
        assert_eq!(whole.iter().map(|s| s.rows).collect::<Vec<_>>(), [12_000, 2999, 4994]);
        let expected = read_all(&model, &data, &whole, intersample);
        for longest in [1000, 4096, 4999, 7001, 12_000] {
            let mut warnings = Vec::new();
            let parts = segments(&model, one, longest, &mut warnings).unwrap();
            let least = |run: &Range<u64>| (run.end - run.start).min(longest / 2);
            assert!(parts.iter().all(|part| part.rows <= longest && part.rows >= least(&part.uninterrupted)));
            assert_eq!(read_all(&model, &data, &parts, intersample), expected, "{longest}");
            assert!(warnings[0].contains("3 gaps"), "{warnings:?}");
            assert!(warnings[1].contains("1 of the parts"), "{warnings:?}");
            assert!(warnings[1].contains("4 samples"), "{warnings:?}");
            assert_eq!(parts.iter().filter(|part| part.starts_uninterrupted()).count(), 3);
        }
    }
}
