//! The settings of every task, as keywords and as the command with the same effect.

use serde_json::{Map, Value, json};
use socam_job::options::{command_line, defaults, from_keywords, words};
use socam_job::{
    Check, Compare, Design, Diagnose, FleetRow, Identify, JobError, Record, Response, Settings, Simulate,
    Watch,
};

fn keywords(value: Value) -> Map<String, Value> {
    value.as_object().unwrap().clone()
}

fn from<T: Settings>(value: Value) -> Result<T, JobError> {
    from_keywords(keywords(value))
}

/// Splits a command line into words like a shell.
fn shell(line: &str) -> Vec<String> {
    let (mut words, mut word, mut is_quoted, mut chars) = (Vec::new(), None, false, line.chars());
    while let Some(c) = chars.next() {
        match c {
            '\'' => {
                is_quoted = !is_quoted;
                word.get_or_insert_with(String::new);
            }
            '\\' if !is_quoted => word.get_or_insert_with(String::new).extend(chars.next()),
            ' ' if !is_quoted => words.extend(word.take()),
            c => word.get_or_insert_with(String::new).push(c),
        }
    }
    words.extend(word);
    words
}

/// Asserts that the command made from settings is parsed back into equal settings.
fn comes_back<T: Settings + PartialEq + std::fmt::Debug>(given: Value) {
    let settings: T = from(given).unwrap();
    let runs = ["a b.mcap".to_owned(), "it's.csv@2..8".to_owned()];
    let line = command_line(&settings, &[("", &runs)]).unwrap();
    let typed = shell(&line);
    let head = 1 + T::COMMAND.len();
    assert_eq!(typed[0], "socam-host");
    assert_eq!(typed[1..head], *T::COMMAND, "{line}");
    assert_eq!(typed[head..head + 2], runs, "{line}");
    let command = T::augment_args(clap::Command::new("task").no_binary_name(true));
    let matches = command.try_get_matches_from(&typed[head + 2..]).unwrap_or_else(|e| panic!("{line}: {e}"));
    assert_eq!(T::from_arg_matches(&matches).unwrap(), settings, "{line}");
    assert!(words(&defaults::<T>().unwrap()).unwrap().is_empty());
}

#[test]
fn the_command_of_every_task_does_the_same() {
    comes_back::<Check>(json!({"ratio_tolerance": 0.02}));
    comes_back::<Check>(json!({"input": "voltage"}));
    comes_back::<Diagnose>(json!({
        "fixed": {"k3": 52485.0}, "start_values": ["k4=120"], "between": {"motor_speed": "hold"}, "false_alarm_rate": 0.05,
        "repeatability": 1e-7, "start": "equilibrium", "tolerance": 0.0, "most": 6, "seed": 18_446_744_073_709_551_615_u64,
    }));
    comes_back::<Identify>(json!({
        "model": "my bench.toml", "method": "inverse-dynamics", "band": [1.5, 50], "noise": {"torque_in": 0.1}, "starts": 3,
        "calibration": "cal's.toml", "outputs": ["a", "b"], "low_pass": [100.0, 2], "orders": "3/6", "stable": true, "outliers": 4.5,
    }));
    comes_back::<Response>(
        json!({"outputs": "output_speed", "band": "1..40", "period_s": 2.0, "quietest": true}),
    );
    comes_back::<Compare>(
        json!({"names": {"w_out": "output_speed"}, "offset_s": -0.25, "false_alarm_rate": 0.1, "model": "emps"}),
    );
    comes_back::<Watch>(
        json!({"false_alarms_per_hour": 0.1, "window_s": 20, "block_s": 0.25, "learn_s": 12.5, "fixed": ["k3"]}),
    );
    comes_back::<Simulate>(json!({
        "profile": "steps", "duration_s": 3.5, "rate_hz": 500, "values": {"k4": 134}, "noise": false, "seed": 3,
        "hide": "coulomb_friction@load_bearing:torque=0.3", "begin_at_s": 2, "between": ["hold"], "from_rest": true,
    }));
    comes_back::<Design>(
        json!({"rival": "b.toml", "limits": {"torque_out": 20.0}, "voltage": 1.5, "one_way": true, "duration_s": 3}),
    );
    comes_back::<FleetRow>(json!({"false_alarm_rate": 0.02, "tolerance": 0.01, "seed": 2, "model": "emps"}));
    comes_back::<Record>(json!({"profile": "chirp", "duration_s": 90, "rate_hz": 2000}));
}

#[test]
fn only_what_differs_from_the_defaults_is_written() {
    let settings: Diagnose = from(json!({"most": 2, "fixed": {"k3": 52485.0}, "seed": 1})).unwrap();
    let line =
        command_line(&settings, &[("", &["run.mcap".into()]), ("--holdout", &["next one.mcap".into()])]);
    assert_eq!(
        line.unwrap(),
        "socam-host diagnose run.mcap --holdout 'next one.mcap' --fix k3=52485.0 --most 2"
    );
}

#[test]
fn what_cannot_be_meant_is_one_sentence_with_the_name_of_its_option() {
    let sentences = |error: JobError| (error.to_string(), error.in_keywords());
    let of = |value| sentences(from::<Diagnose>(value).unwrap_err());
    let expected = "2: expected a number between 0 and 1";
    assert_eq!(
        of(json!({"false_alarm_rate": 2})),
        (format!("--false-alarm-rate {expected}"), format!("false_alarm_rate {expected}"))
    );
    assert_eq!(of(json!({"most": 7})).1, "most: 7 is not in 1..=6");
    assert_eq!(of(json!({"start": "slow"})).1, "start: `slow` is neither free nor equilibrium");
    assert!(matches!(from::<Diagnose>(json!({"most": "many"})), Err(JobError::Keyword(_))));
    let unknown = of(json!({"false_alarms": 0.1})).1;
    assert!(unknown.starts_with("there is no option `false_alarms`; the options are "), "{unknown}");
    assert!(unknown.contains("false_alarm_rate") && unknown.contains("between"), "{unknown}");
    let of = |value| sentences(from::<Record>(value).unwrap_err()).1;
    assert_eq!(of(json!({"rate_hz": 3e5})), "rate_hz is 300000.0 Hz; a board samples at 1 to 20000 Hz");
    let of = |value| sentences(from::<Design>(value).unwrap_err()).1;
    assert!(of(json!({"rival": "a", "diagnosis": "b"})).contains("cannot be given together with"));
}

#[test]
fn rates_are_whole_microseconds_and_runs_last_a_day_at_most() {
    let record = |rate_hz| Record { rate_hz, ..defaults().unwrap() };
    assert_eq!(record(10_000.0).period_us().unwrap(), 100);
    for rate in [0.0, -1.0, 3000.0, 30_000.0, f64::NAN] {
        assert!(record(rate).period_us().is_err(), "{rate}");
    }
    let lasting = |duration_s| Record {
        profile: Some("multisine".into()),
        duration_s: Some(duration_s),
        ..defaults().unwrap()
    };
    assert!(lasting(80_000.0).load().is_ok());
    assert!(lasting(90_000.0).load().unwrap_err().to_string().contains("at most 24 h"));
}
