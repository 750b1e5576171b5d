use super::*;

#[test]
fn rates_are_whole_microseconds() {
    assert_eq!(period_us(10_000.0).unwrap(), 100);
    for rate in [0.0, -1.0, 3000.0, 30_000.0, f64::NAN] {
        assert!(period_us(rate).is_err(), "{rate}");
    }
}

#[test]
fn a_run_of_more_than_a_day_is_refused() {
    let course = |duration_s| CourseArgs {
        profile: Some("multisine".into()),
        duration: Some(duration_s),
        rate: 1000.0,
    };
    assert!(plan(&course(80_000.0), "run.mcap".into()).is_ok());
    for duration_s in [90_000.0, 1e12] {
        let problem = plan(&course(duration_s), "run.mcap".into()).err().unwrap().to_string();
        assert!(problem.contains("at most 24 h"), "{problem}");
    }
}
