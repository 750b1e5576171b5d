//! Intersample behaviour, bounds, constraints, gaps, threads, and input that cannot be used.

use super::*;

#[test]
fn a_linear_hold_biases_damping_and_a_band_limited_one_does_not() {
    let data = [bench(TRUTH, 4.0, 0.02, 2)];
    let mut model = model(|text| text);
    fix(&mut model, &[("k2", 54.4), ("k3", 52485.0), ("c3", 0.02)]);
    let error = |intersample| {
        let options = Options { intersample: Some(intersample), starts: 1, ..Options::default() };
        let result = output_error(&Problem::new(&model, &data, options).unwrap()).unwrap();
        (result.point[model.parameter("c2").unwrap()] / 0.02 - 1.0).abs()
    };
    let (linear, sharp) = (error(Intersample::Linear), error(Intersample::BandLimited));
    assert!(linear > 0.01 && sharp < 0.3 * linear, "linear {linear}, band-limited {sharp}");
}

#[test]
fn bounds_constraints_and_priors_hold() {
    let data = [bench(TRUTH, 3.0, 1.0, 4)];
    let mut tight = model(|text| {
        text.replace(
            "k4 = { value = 1.92, unit = \"N m/deg\", bounds = [0.01, 100]",
            "k4 = { value = 1.5, unit = \"N m/deg\", bounds = [1, 1.6]",
        )
    });
    fix(&mut tight, &[("k2", 54.4), ("k3", 52485.0), ("c3", 0.02)]);
    let result =
        output_error(&Problem::new(&tight, &data, Options { starts: 1, ..Options::default() }).unwrap())
            .unwrap();
    let k4 = tight.parameter("k4").unwrap();
    assert!((result.point[k4] / tight.parameters[k4].bounds.1 - 1.0).abs() < 1e-6, "{}", result.point[k4]);
    assert!(!result.parameters[k4].identifiable && result.parameters[k4].note.contains("bound"));

    let free = model(|text| text);
    let index = |name: &str| free.parameter(name).unwrap();
    let equal = Constraint { terms: vec![(index("k1"), 1.0), (index("k2"), -1.0)], lower: 0.0, upper: 0.0 };
    let mut start = free.clone();
    start.parameters[index("k2")].value = start.parameters[index("k1")].value;
    let options = Options { starts: 1, constraints: vec![equal], ..Options::default() };
    let result = output_error(&Problem::new(&start, &data, options).unwrap()).unwrap();
    let (k1, k2) = (result.point[index("k1")], result.point[index("k2")]);
    assert!((k1 / k2 - 1.0).abs() < 1e-6, "{k1} {k2}");
    let series = 71.0 * 54.4 / (71.0 + 54.4);
    assert!((0.5 * k1 / series - 1.0).abs() < 1e-2, "{k1}");

    let prior =
        model(|text| text.replace("source = \"identified, table 4.6\"", "prior = { value = 916, std = 20 }"));
    let result =
        output_error(&Problem::new(&prior, &data, Options { starts: 1, ..Options::default() }).unwrap())
            .unwrap();
    let k3 = &result.parameters[index("k3")];
    assert!(k3.identifiable && k3.source == crate::Source::Prior, "{k3:?}");
}

#[test]
fn gaps_and_missing_values_are_survived() {
    let whole = bench(TRUTH, 4.0, 1.0, 9);
    let loaded = whole.load(&["motor_speed", "output_speed", "torque_in", "torque_out"]).unwrap();
    let keep: Vec<usize> = (0..loaded.time_s.len()).filter(|k| !(1500..1600).contains(k)).collect();
    let time = keep.iter().map(|k| loaded.time_s[*k]).collect();
    let mut columns: Vec<Vec<f64>> =
        loaded.columns.iter().map(|c| keep.iter().map(|k| c.values()[*k]).collect()).collect();
    columns[2][200..900].fill(f64::NAN);
    columns[0][3000] = f64::NAN;
    let holed = [Dataset::from_columns("holed", whole.channels().to_vec(), time, columns).unwrap()];
    let mut model = model(|text| text);
    fix(&mut model, &[("k2", 54.4), ("k3", 52485.0), ("c3", 0.02)]);
    let problem = Problem::new(&model, &holed, Options { starts: 1, ..Options::default() }).unwrap();
    assert_eq!(problem.segments.len(), 3);
    let result = output_error(&problem).unwrap();
    let k4 = &result.parameters[model.parameter("k4").unwrap()];
    assert!((k4.value.unwrap() / 110.0 - 1.0).abs() < 0.01, "{k4:?}");
    assert!(result.warnings.iter().any(|w| w.contains("2 gaps")), "{:?}", result.warnings);
}

#[test]
fn the_same_digits_whatever_the_number_of_threads() {
    let data = [bench(TRUTH, 2.0, 1.0, 1), bench(TRUTH, 3.0, 1.0, 2), bench(TRUTH, 0.7, 1.0, 3)];
    let model =
        model(|text| text.replace("at = \"coupling_1\"", "at = \"coupling_1\"\nestimate_offset = true"));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let options = Options { starts: 2, ..Options::default() };
            let mut problem = Problem::new(&model, &data, options).unwrap();
            problem.segments = segments::segments(&model, &data, 450, &mut Vec::new()).unwrap();
            assert!(problem.segments.len() > 10);
            let mut result = output_error(&problem).unwrap();
            result.cpu_s = 0.0;
            let point: Vec<u64> = result.point.iter().map(|value| value.to_bits()).collect();
            (serde_json::to_string(&result).unwrap(), point)
        })
    };
    let alone = run(1);
    assert_eq!(alone, run(2));
    assert_eq!(alone, run(3));
}

#[test]
fn input_that_cannot_be_used_is_named() {
    let model = model(|text| text);
    let refused =
        |datasets: &[Dataset]| Problem::new(&model, datasets, Options::default()).unwrap_err().to_string();
    assert!(refused(&[]).contains("no recording"));
    assert!(refused(&[bench(TRUTH, 0.01, 0.0, 1)]).contains("10 samples"));
    assert!(
        refused(&[emps_data()]).contains("motor_speed_rad_s")
            || refused(&[emps_data()]).contains("output_speed_rad_s")
    );
    let data = [bench(TRUTH, 0.1, 0.0, 1)];
    let known = Options {
        noise: Noise::Given(NoiseLevels { outputs: vec![0.02, 0.01, 0.05], inputs: vec![0.0] }),
        starts: 1,
        ..Options::default()
    };
    assert!(output_error(&Problem::new(&model, &data, known).unwrap()).is_ok());
}
