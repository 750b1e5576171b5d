#[test]
fn dates_are_those_of_the_calendar() {
    let date = |seconds: u64| super::utc(seconds * 1_000_000_000);
    assert_eq!(date(0), "1970-01-01 00:00:00 UTC");
    assert_eq!(date(951_782_400), "2000-02-29 00:00:00 UTC");
    assert_eq!(date(1_709_251_199), "2024-02-29 23:59:59 UTC");
    assert_eq!(date(1_735_689_600), "2025-01-01 00:00:00 UTC");
}
