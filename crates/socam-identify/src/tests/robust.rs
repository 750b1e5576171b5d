//! Fits to recordings with spikes, saturation and gaps, of different rates and lengths, compared with fits to clean recordings.

use socam_model::Model;
use socam_recording::Dataset;

use crate::{
    Identification, Options, Problem, Reason, comparison, output_error,
    tests::{TRUTH, bench, fix, model, with_friction},
    uncertainty::jackknife,
};

const NAMES: [&str; 4] = ["motor_speed", "output_speed", "torque_in", "torque_out"];

/// Some rows of a recording, its values changed.
fn changed(data: &Dataset, keep: impl Fn(usize) -> bool, change: impl Fn(&mut [Vec<f64>])) -> Dataset {
    let loaded = data.load(&NAMES).unwrap();
    let rows: Vec<usize> = (0..loaded.time_s.len()).filter(|row| keep(*row)).collect();
    let time_s = rows.iter().map(|row| loaded.time_s[*row]).collect();
    let column = |values: &[f64]| rows.iter().map(|row| values[*row]).collect();
    let mut columns: Vec<Vec<f64>> = loaded.columns.iter().map(|c| column(c.values())).collect();
    change(&mut columns);
    Dataset::from_columns(data.name(), data.channels().to_vec(), time_s, columns).unwrap()
}

fn fitted(data: &[Dataset]) -> Identification {
    let mut model = model(|text| text);
    fix(&mut model, &[("k2", TRUTH[1]), ("k3", TRUTH[2]), ("c3", TRUTH[5])]);
    output_error(&Problem::new(&model, data, Options { starts: 1, ..Options::default() }).unwrap()).unwrap()
}

/// Asserts that each determined parameter agrees with a clean fit, and that its interval contains the truth (widened, because five
/// are tested).
fn assert_alike(result: &Identification, clean: &Identification) {
    let truths = [("k1", TRUTH[0]), ("k4", TRUTH[3]), ("c2", TRUTH[4]), ("c4", TRUTH[6]), ("c5", TRUTH[7])];
    for (name, truth) in truths {
        let find = |result: &Identification| {
            let found = result.parameters.iter().find(|parameter| parameter.name == name).unwrap();
            (found.value.unwrap(), found.std.unwrap())
        };
        let ((value, std), (clean, clean_std)) = (find(result), find(clean));
        assert!((value - truth).abs() < 3.0 * std, "{name}: {value} +- {std}, truth {truth}");
        assert!((value - clean).abs() < 1.5 * clean_std, "{name}: {value} against {clean} +- {clean_std}");
        assert!((0.7..1.5).contains(&(std / clean_std)), "{name}: {std} against {clean_std}");
    }
}

fn samples(result: &Identification, channel: &str, reason: Reason) -> u64 {
    let own = result.left_out.iter().filter(|note| note.channel == channel && note.reason == reason);
    own.map(|note| note.samples).sum()
}

/// More than one in a hundred, as a bus fails; a command may have as many pulses, but at regular distances.
#[test]
fn failed_reads_of_an_input_are_replaced_and_pulses_are_not() {
    let whole = bench(TRUTH, 4.0, 1.0, 21);
    let model = model(|text| text);
    let replaced = |at: &dyn Fn(usize) -> usize| {
        let failing = changed(&whole, |_| true, |columns| (1..48).for_each(|k| columns[0][at(k)] = 0.0));
        let problem = Problem::new(&model, std::slice::from_ref(&failing), Options::default()).unwrap();
        problem
            .left_out
            .iter()
            .filter(|note| note.reason == Reason::Imputed)
            .map(|note| note.samples)
            .sum::<u64>()
    };
    assert_eq!(replaced(&|k| (0..k).map(|j| 20 + (j * j * 31 % 59).pow(2) / 30).sum()), 47);
    assert_eq!(replaced(&|k| 80 * k), 0);
}

#[test]
fn spikes_saturation_and_gaps_do_not_move_the_estimates() {
    let whole = [bench(TRUTH, 4.0, 1.0, 21), bench(TRUTH, 3.0, 1.0, 22), bench(TRUTH, 2.5, 1.0, 23)];
    let halved = |data: &Dataset| changed(data, |row| row % 2 == 0, |_| {});
    let clean = fitted(&[whole[0].clone(), halved(&whole[1]), whole[2].clone()]);
    assert!(clean.left_out.is_empty(), "{:?}", clean.left_out);

    let spiked = changed(
        &whole[0],
        |_| true,
        |columns| {
            for k in 0..20 {
                columns[1 + k % 3][97 + 190 * k] += if k % 2 == 0 { 4.0 } else { -6.0 };
            }
            for row in [333, 1500, 3071] {
                columns[0][row] += 25.0;
            }
        },
    );
    let limit = 0.98 * whole[1].statistics()[3].max.unwrap();
    let clip = |columns: &mut [Vec<f64>]| {
        columns[3][600..720].fill(limit);
        columns[3].iter_mut().for_each(|torque| *torque = torque.min(limit));
    };
    let clipped = changed(&whole[1], |row| row % 2 == 0, clip);
    let holed = changed(&whole[2], |row| !(700..900).contains(&row), |_| {});
    let result = fitted(&[spiked, clipped, holed]);
    assert_alike(&result, &clean);
    let outliers =
        ["output_speed", "torque_in", "torque_out"].map(|name| samples(&result, name, Reason::Outliers));
    assert_eq!(outliers, [7, 7, 6], "{:?}", result.left_out);
    assert_eq!(samples(&result, "motor_speed", Reason::Imputed), 3, "{:?}", result.left_out);
    assert!(samples(&result, "torque_out", Reason::Saturated) >= 120, "{:?}", result.left_out);
    for text in ["has outliers in 7 places", "is saturated in", "has spikes in 3 places", "1 gap"] {
        assert!(
            result.warnings.iter().any(|warning| warning.contains(text)),
            "{text}: {:?}",
            result.warnings
        );
    }
}

#[test]
fn what_the_model_does_not_describe_is_not_masked() {
    // A torque that the model lacks, in every twentieth of a second for a while.
    let data = [changed(
        &bench(TRUTH, 4.0, 1.0, 24),
        |_| true,
        |columns| {
            for row in (0..4000).filter(|row| row % 200 < 10) {
                columns[3][row] += 2.0;
            }
        },
    )];
    let result = fitted(&data);
    assert!(result.left_out.is_empty(), "{:?}", result.left_out);
    let said = result
        .warnings
        .iter()
        .any(|warning| warning.contains("torque_out") && warning.contains("no outliers"));
    assert!(said, "{:?}", result.warnings);
}

#[test]
fn a_law_too_steep_for_any_step_is_said() {
    let steep = |text: String| {
        let text = with_friction(text);
        text.replace("{ torque = \"Tc\" }", "{ torque = \"Tc\", transition_speed = \"Tv\" }")
            .replace("Tc = {", "Tv = { value = 1e-7, unit = \"rad/s\", fixed = true }\nTc = {")
    };
    // The speed changes its sign, and so does the friction.
    let data = [changed(
        &bench(TRUTH, 2.0, 1.0, 25),
        |_| true,
        |columns| {
            columns[0].iter_mut().for_each(|speed| *speed -= 60.0);
        },
    )];
    let mut model = model(steep);
    model.parameters.iter_mut().for_each(|parameter| parameter.fixed = parameter.name != "Tc");
    let result =
        output_error(&Problem::new(&model, &data, Options { starts: 1, ..Options::default() }).unwrap())
            .unwrap();
    assert!(result.warnings.iter().any(|warning| warning.contains("steeper than")), "{:?}", result.warnings);
}

/// The thesis' bench at its fit, evaluated under the noise levels of the fit.
fn at_its_fit<T>(
    data: &[Dataset],
    ask: impl Fn(&Problem<'_>, &comparison::NoiseModel, &Model, &comparison::Evaluation) -> T,
) -> T {
    let mut model = model(|text| text);
    fix(&mut model, &[("k2", TRUTH[1]), ("k3", TRUTH[2]), ("c3", TRUTH[5])]);
    let problem = Problem::new(&model, data, Options { starts: 1, ..Options::default() }).unwrap();
    let fit = output_error(&problem).unwrap();
    let outputs = fit.fit.channels.iter().map(|(_, channel)| channel.noise_std).collect();
    let inputs = fit.input_noise_std.iter().map(|(_, std)| *std).collect();
    let noise_model =
        comparison::NoiseModel::new(&[&problem], &fit.point, crate::NoiseLevels { outputs, inputs }).unwrap();
    let at = comparison::descend(&problem, &noise_model, &fit.point, None, (comparison::FINE, 10))
        .unwrap()
        .unwrap();
    ask(&problem, &noise_model, &model, &at)
}

#[test]
fn recordings_that_differ_by_more_than_noise_widen_what_hangs_on_them() {
    let half_width = |viscous: [f64; 4]| {
        let with =
            |c5: f64| [TRUTH[0], TRUTH[1], TRUTH[2], TRUTH[3], TRUTH[4], TRUTH[5], TRUTH[6], c5, TRUTH[8]];
        let data: Vec<Dataset> = (0..4).map(|k| bench(with(viscous[k]), 1.5, 1.0, 60 + k as u64)).collect();
        at_its_fit(&data, |problem, noise_model, model, at| {
            let widths = jackknife::half_widths(problem, noise_model, model, at).unwrap().unwrap();
            widths[model.parameter("c5").unwrap()]
        })
    };
    // Student's t of three degrees of freedom times the standard error of these four, 0.00041.
    let (same, different) = (half_width([0.05; 4]), half_width([0.049, 0.0504, 0.051, 0.0496]));
    assert!(same < 2e-4, "{same}");
    assert!((0.0007..0.0026).contains(&different), "{different}");
}
