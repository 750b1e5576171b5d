use super::*;

fn report() -> Report {
    examine().unwrap()
}

fn find<'a>(report: &'a Report, place: &str, what: &str) -> &'a Row {
    let rows = report.tables.iter().filter(|table| table.place == place).flat_map(|table| &table.rows);
    rows.into_iter().find(|row| row.what == what).unwrap_or_else(|| panic!("no {what} in {place}"))
}

#[test]
fn a_printed_number_knows_its_last_digit() {
    let printed = |text: &str| Printed::try_from(text.to_owned()).unwrap();
    assert_eq!(printed("1.24").half_unit, 0.005);
    assert!((printed("0.123e13").half_unit - 0.5e10).abs() < 1.0);
    assert!(printed("0.1252").agrees(0.12521, 0.0) && !printed("0.1252").agrees(0.1253, 0.0));
    assert!(Printed::try_from("x".to_owned()).is_err());
}

#[test]
fn all_seventeen_points_are_judged_with_their_calculation() {
    let report = report();
    for number in 1..=17 {
        let point = report.points.iter().find(|point| point.number == number).unwrap();
        assert!(!point.calculation.is_empty() && !point.conclusion.is_empty(), "{number}");
    }
    for number in [9, 10, 11] {
        let point = report.points.iter().find(|point| point.number == number).unwrap();
        assert_eq!(point.verdict, Verdict::Concealed);
        assert!(point.conclusion.contains("Concealed"), "{number}");
    }
}

#[test]
fn what_holds_holds_and_what_does_not_is_said() {
    let report = report();
    for (place, what, holds) in [
        ("Table 4.1", "mode 1, natural frequency", false),
        ("Table 4.1", "mode 2, natural frequency", true),
        ("Table 4.1", "mode 3, damping ratio", true),
        ("Section 4.1.1", "H(0)", true),
        ("Table 4.4", "w_10", false),
        ("Table 5.1", "efficiency at 500 rpm", true),
        ("Table 5.2", "efficiency at 1500 rpm", false),
        ("Table 5.3", "efficiency at 1500 rpm", true),
        ("Table 5.4", "reducer at 1500 rpm", false),
        ("Eq. 4.7a to 4.7j", "phi_9", true),
        ("Eq. 4.7a to 4.7j", "phi_10", false),
        ("Table 4.6", "k3", true),
    ] {
        let row = find(&report, place, what);
        assert_eq!(row.holds, holds, "{place}: {row:?}");
    }
    let ours = |place: &str, what: &str| find(&report, place, what).ours.unwrap();
    assert!((ours("Table 4.1", "mode 1, natural frequency") - 20.197).abs() < 1e-3);
    assert!((ours("Table 5.4", "reducer at 1500 rpm") - 90.543).abs() < 1e-3);
    let said = |number: u32| &report.points.iter().find(|point| point.number == number).unwrap().calculation;
    for share in ["88.76 %", "88.06 %", "88.62 %"] {
        assert!(said(10).iter().any(|line| line.ends_with(share)), "{:?}", said(10));
    }
}
