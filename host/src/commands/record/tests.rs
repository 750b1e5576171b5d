use super::*;

#[test]
fn times_are_read() {
    for (text, expected) in
        [("10s", 10.0), ("10", 10.0), ("1.5min", 90.0), ("500ms", 0.5), ("1e-1s", 0.1), ("1e1", 10.0)]
    {
        assert!((seconds(text).unwrap() - expected).abs() < 1e-12, "{text}");
    }
    for text in ["-1s", "0s", "ten", "5 years", "", "nan", "inf"] {
        assert!(seconds(text).is_err(), "{text}");
    }
}

#[test]
fn rates_are_whole_microseconds() {
    assert_eq!(period_us(10_000.0).unwrap(), 100);
    for rate in [0.0, -1.0, 3000.0, 30_000.0, f64::NAN] {
        assert!(period_us(rate).is_err(), "{rate}");
    }
}
