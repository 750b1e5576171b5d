use super::*;

#[test]
fn a_run_of_more_than_a_day_is_refused() {
    let record = |duration_s| Record {
        profile: Some("multisine".into()),
        duration_s: Some(duration_s),
        rate_hz: 1000.0,
    };
    assert!(plan(&record(80_000.0), "run.mcap".into()).is_ok());
    for duration_s in [90_000.0, 1e12] {
        let problem = plan(&record(duration_s), "run.mcap".into()).err().unwrap().to_string();
        assert!(problem.contains("at most 24 h"), "{problem}");
    }
}
