use super::*;

fn table(head: &str, row: impl Fn(f64) -> Vec<f64>) -> Pairs {
    let wobble = |i: usize| 1.0 + 1e-3 * [1.0, -1.0, 0.3, -0.3][i % 4];
    let rows = (1..=12).map(|i| {
        let cells = row(f64::from(i));
        let last = cells.len() - 1;
        let text: Vec<String> = cells
            .iter()
            .enumerate()
            .map(|(k, v)| (if k == last { v * wobble(i as usize) } else { *v }).to_string())
            .collect();
        text.join(",")
    });
    let text = std::iter::once(head.to_owned()).chain(rows).collect::<Vec<_>>().join("\n");
    Pairs::parse("pairs.csv".into(), &text).unwrap()
}

#[test]
fn columns_say_what_is_calibrated() {
    let tachometer = table("motor_speed_rpm,motor_speed_V", |i| vec![100.0 * i, 0.69 * i]);
    let found = of(&tachometer, &Assumed::default()).unwrap();
    let sensor = found.tasks[0].measured_sensor().unwrap();
    assert_eq!(sensor.channel, "motor_speed");
    assert!((sensor.sensor.volts_per_unit / Sensor::MOTOR_SPEED.volts_per_unit - 1.0).abs() < 2e-3);
    let motor = table("command_V,motor_speed_rpm", |i| vec![0.1 * i, 72.0 * i - 12.0]);
    let line = of(&motor, &Assumed::default()).unwrap().tasks[0].measured_motor().unwrap();
    assert!((line.rpm_per_volt - 720.0).abs() < 3.0 && (line.offset_rpm + 12.0).abs() < 3.0);
    let coupling = table("k4_twist_deg,k4_torque_Nm", |i| vec![0.1 * i, 0.192 * i]);
    let found = of(&coupling, &Assumed::default()).unwrap();
    let (name, prior) = found.tasks[0].prior().unwrap();
    assert!(name == "k4" && (prior.value / (1.92 * 57.295_78) - 1.0).abs() < 2e-3 && prior.std > 0.0);
    let unknown = table("heat_V,depth_mm", |i| vec![i, i]);
    assert!(
        of(&unknown, &Assumed::default())
            .unwrap_err()
            .to_string()
            .contains("heat_V of `pairs.csv` stands alone")
    );
}

#[test]
fn torque_by_power_carries_the_efficiencys_uncertainty() {
    let pairs = table("motor_V,motor_A,motor_speed_rad_s,torque_in_V", |i| {
        vec![80.0, 0.1 * i, 100.0, 2.0 * 0.85 * 0.08 * i]
    });
    let asked = of(&pairs, &Assumed::default()).unwrap_err().to_string();
    assert!(asked.contains("--motor-efficiency"), "{asked}");
    let assumed = Assumed { motor_efficiency: Some((0.85, 0.0255)), ..Assumed::default() };
    let sensor = of(&pairs, &assumed).unwrap().tasks[0].measured_sensor().unwrap();
    assert!((sensor.sensor.volts_per_unit - 2.0).abs() < 0.01);
    assert!((sensor.gain_std - 0.03).abs() < 0.002, "{}", sensor.gain_std);
}
