//! Chapter 2: sensors, converter, motor, program; points 3 and 12 to 16.

use std::f64::consts::TAU;

use crate::{
    Thesis,
    report::{Report, Verdict, row, short},
};

/// Nominal speeds of the experiments, rpm: the highest of chapter 5.
const FASTEST_ROW: usize = 2;

pub(crate) fn examine(thesis: &Thesis, report: &mut Report) {
    let hardware = &thesis.hardware;
    let rows = hardware.recording_s.value / (1e-3 * hardware.recording_step_ms.value);
    report.table(
        "Section 4.1.1",
        "Recordings",
        vec![row(
            "samples of a recording",
            "1",
            &hardware.recording_rows,
            rows,
            0.0,
            format!("{} s / {} ms", hardware.recording_s.text, hardware.recording_step_ms.text),
        )],
    );
    let program = hardware.recording_s.value / (1e-3 * hardware.program_step_ms.value);
    report.point(
        3,
        Verdict::Refuted,
        "10 s at 10 ms are not 10000 samples",
        vec![
            format!("10 s / 10 ms = {} samples; printed: {}", short(rows), hardware.recording_rows.text),
            format!(
                "10 s / {} ms, the program's step at 1 Hz and above, = {} samples",
                hardware.program_step_ms.text,
                short(program)
            ),
        ],
        "The step was 1 ms, as the program's listing has it.",
    );
    converter(thesis, report);
    motor(thesis, report);
    calibration(thesis, report);
    report.point(
        16,
        Verdict::Refuted,
        "The program of Appendix A trusts its converter, its timer and its user",
        vec![
            "while (busy) timeout--; then if (timeout == 0) return 0xffff: the loop does not look at the counter, which passes 0 and wraps".into(),
            format!("0xffff taken for a voltage: 65535 x 20/4096 - 10 = {} V", short(65535.0 * 20.0 / 4096.0 - 10.0)),
            format!(
                "SIZE_ARRAY is {} in SimpleDoc.cpp and {} in TextureTimer.cpp; the index of data_sensors is not compared with either",
                hardware.program_rows[0].text, hardware.program_rows[1].text
            ),
            format!("ten periods at T/1000 are {} rows: {} times the smaller array", short(program), short(program / hardware.program_rows[1].value)),
        ],
        "A conversion that never ends hangs the program with the motor running; nothing but the timer stops it. (This point is read from \
         the listing, not computed.)",
    );
}

fn converter(thesis: &Thesis, report: &mut Report) {
    let hardware = &thesis.hardware;
    let range_v = hardware.converter_range_V.value;
    let count_v = 2.0 * range_v / 2_f64.powf(hardware.converter_bits.value);
    let torque = &thesis.efficiency.system[0][4];
    let as_printed_nm = count_v / (1e-3 * hardware.input_torque_sensor_mV_per_Nm.value);
    let as_volts = torque.value * hardware.output_torque_sensor_mV_per_Nm.value;
    report.point(
        12,
        Verdict::Refuted,
        "The torque sensors' sensitivities cannot be mV/N m, nor V/N m",
        vec![
            format!(
                "one count: 2 x {} V / 2^{} = {} mV",
                hardware.converter_range_V.text,
                hardware.converter_bits.text,
                short(1e3 * count_v)
            ),
            format!(
                "at {} mV/N m that is {} N m",
                hardware.input_torque_sensor_mV_per_Nm.text,
                short(as_printed_nm)
            ),
            format!(
                "at {} V/N m the {} N m of Table 5.1 are {} V, beyond {} V",
                hardware.output_torque_sensor_mV_per_Nm.text,
                torque.text,
                short(as_volts),
                hardware.converter_range_V.text
            ),
        ],
        "Table 2.7 cannot be what was used: the torques of chapter 5 have four digits.",
    );
    let limit_rpm = 1e3 * range_v / hardware.input_tachometer_V_per_krpm.value;
    let fastest = &thesis.efficiency.system[FASTEST_ROW];
    let measured_rpm = fastest[1].value * 60.0 / TAU;
    report.point(
        13,
        Verdict::Refuted,
        "The 1500 rpm rows lie outside the converter's range",
        vec![
            format!(
                "{} V / {} V/krpm = {} rpm",
                hardware.converter_range_V.text,
                hardware.input_tachometer_V_per_krpm.text,
                short(limit_rpm)
            ),
            format!(
                "{} rad/s of Table 5.1 = {} rpm = {} V",
                fastest[1].text,
                short(measured_rpm),
                short(1e-3 * measured_rpm * hardware.input_tachometer_V_per_krpm.value)
            ),
        ],
        "Either the sensitivity of Table 2.7 is wrong or these rows were not read through this converter.",
    );
}

fn motor(thesis: &Thesis, report: &mut Report) {
    let motor = &thesis.motor;
    let speed = motor.speed_rpm.value * TAU / 60.0;
    let power = motor.voltage_V.value * motor.current_A.value * 0.01 * motor.efficiency_percent.value;
    let torque = power / speed;
    let drag = motor.damping_Nm_per_rpm.value * motor.speed_rpm.value;
    let start_s = motor.inertia_Nms2.value * speed / torque;
    let matching = &thesis.matching;
    let table_4_2 = matching.motor_inertia.value * 1e-3 * 180.0 / std::f64::consts::PI;
    let right = motor.inertia_Nms2.value * 1e3 * std::f64::consts::PI / 180.0;
    let by_time_constant = 1e-3 * matching.torque_Nmm.value * matching.time_constant_s.value
        / matching.speed_deg_s.value.to_radians();
    report.point(
        14,
        Verdict::Refuted,
        "The motor's damping and inertia are impossible",
        vec![
            format!(
                "{} V x {} A x {} % = {} W, at {} rpm {} N m",
                motor.voltage_V.text,
                motor.current_A.text,
                motor.efficiency_percent.text,
                short(power),
                motor.speed_rpm.text,
                short(torque)
            ),
            format!(
                "{} N m/rpm x {} rpm = {} N m of drag",
                motor.damping_Nm_per_rpm.text,
                motor.speed_rpm.text,
                short(drag)
            ),
            format!(
                "{} N m s2 x {} rad/s / {} N m = {} s to speed; its time constant is {} s",
                motor.inertia_Nms2.text,
                short(speed),
                short(torque),
                short(start_s),
                matching.time_constant_s.text
            ),
            format!("T tau / omega of Table 4.2 = {} kg m2", short(by_time_constant)),
            format!(
                "Table 4.2: {} N mm s2/deg = {} kg m2; {} kg m2 would be {} N mm s2/deg",
                matching.motor_inertia.text,
                short(table_4_2),
                motor.inertia_Nms2.text,
                short(right)
            ),
        ],
        "Factors of about 1e5 and more; the characteristic damping of Table 4.2 is built on the same slip.",
    );
}

fn calibration(thesis: &Thesis, report: &mut Report) {
    let [loaded, free] = [&thesis.hardware.calibration_loaded, &thesis.hardware.calibration_free];
    let at = |line: &[crate::Printed; 2], volts: f64| line[0].value * volts + line[1].value;
    let lines = [1.0, 1.5, 2.0].map(|volts| {
        format!(
            "{volts} V: {} rpm with mechanism and load, {} rpm without",
            short(at(loaded, volts)),
            short(at(free, volts))
        )
    });
    let crossing = (free[1].value - loaded[1].value) / (loaded[0].value - free[0].value);
    report.point(
        15,
        Verdict::Refuted,
        "The motor turns faster with its load than without",
        lines
            .into_iter()
            .chain([format!("the lines cross at {} V, outside the range of commands", short(crossing))])
            .collect(),
        "The captions of eq. 2.1 and 2.2 are likely swapped.",
    );
}
