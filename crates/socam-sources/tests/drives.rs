//! Drives against their simulations: what is asked is answered, and what no drive answers becomes no sample.

use proptest::prelude::*;
use socam_sources::moteus::Moteus;
use socam_sources::odrive::Odrive;
use socam_sources::simulators::{
    DynamixelSimulator, FeetechSimulator, Firmware, Mishap, MoteusSimulator, Motor, OdriveSimulator,
};
use socam_sources::{Chunk, Device, Heard, Row, Servos, dynamixel, feetech};

fn motor() -> Motor {
    let mut motor = Motor::turning(12.5, 0.25, 24.0);
    motor.torque_constant_nm_a = 0.125;
    motor
}

fn turning(speed_rad_s: f64) -> Motor {
    let mut motor = motor();
    motor.speed_rad_s = speed_rad_s;
    motor
}
const PERIOD_NS: i64 = 1_000_000;
/// Time from question to answer, ns.
const ROUND_NS: i64 = 400_000;

/// Asks a drive for some seconds; `change` may damage an answer on its way.
fn ask(
    device: &mut dyn Device,
    seconds: f64,
    mut drive: impl FnMut(f64, &[u8]) -> Vec<u8>,
    mut change: impl FnMut(usize, Vec<u8>) -> Vec<u8>,
) -> Vec<Heard> {
    let (mut now_ns, mut heard, mut turn) = (0_i64, Vec::new(), 0);
    while (now_ns as f64) < seconds * 1e9 {
        let mut question = Vec::new();
        let next_ns = device.poll(now_ns, &mut question).unwrap().unwrap();
        if question.is_empty() {
            now_ns = next_ns.max(now_ns + 1);
            continue;
        }
        turn += 1;
        let answer = change(turn, drive(now_ns as f64 * 1e-9, &question));
        let chunk = Chunk { bytes: &answer, from_ns: now_ns, until_ns: now_ns + ROUND_NS };
        device.receive(chunk, &mut heard);
        now_ns += ROUND_NS;
    }
    heard
}

fn rows(heard: &[Heard]) -> Vec<&Row> {
    heard.iter().filter_map(|heard| if let Heard::Row(row) = heard { Some(row) } else { None }).collect()
}

#[test]
fn a_moteus_is_recorded_at_its_interval() {
    let mut device = Moteus::new(3, PERIOD_NS).unwrap();
    let mut drive = MoteusSimulator::new(3, motor());
    let heard = ask(&mut device, 2.0, |time_s, bytes| drive.receive(time_s, bytes), |_, answer| answer);
    let rows = rows(&heard);
    // The first line of a stream may be the end of one that began before.
    assert!(
        (1995..=2000).contains(&rows.len()) && heard.len() <= rows.len() + 1,
        "{} {:?}",
        rows.len(),
        heard.first()
    );
    let row = rows[1000];
    assert_eq!(row.values[3..6], [0.25, 2.0, 24.0]);
    assert!((row.values[2] - 12.5).abs() < 1e-6 && (row.values[6] - 308.15).abs() < 1e-4, "{row:?}");
    let expected = 12.5 * (row.arrival_ns - row.spread_ns) as f64 * 1e-9;
    assert!((row.values[1] - expected).abs() < 0.01, "{} for {expected}", row.values[1]);
    assert!(row.spread_ns <= ROUND_NS);

    let mut device = Moteus::new(3, PERIOD_NS).unwrap();
    drive.mishap = Some(Mishap::Fault(33));
    let heard = ask(&mut device, 0.1, |time_s, bytes| drive.receive(time_s, bytes), |_, answer| answer);
    let faults: Vec<_> = heard.iter().filter(|heard| matches!(heard, Heard::Fault(_))).collect();
    assert_eq!(faults, [&Heard::Fault("the moteus reports fault 33 (motor driver fault)".into())]);
}

#[test]
fn an_odrive_of_either_generation_is_recorded() {
    for firmware in [Firmware::Early, Firmware::Late] {
        let mut device = Odrive::new(0, PERIOD_NS).unwrap();
        let mut drive = OdriveSimulator::new(firmware, motor());
        let heard = ask(&mut device, 1.0, |time_s, bytes| drive.receive(time_s, bytes), |_, answer| answer);
        let rows = rows(&heard);
        assert!(rows.len() > 990, "{}", rows.len());
        // The drive is asked by the earlier names first.
        assert!(rows[1..].iter().all(|row| row.values[2..] == [2.0, 24.0, 0.0]), "{:?}", rows[1]);
        assert!((rows[990].values[1] - 12.5).abs() < 1e-4, "{:?}", rows[990]);
        assert_eq!(drive.commands, 0);
    }
}

#[test]
fn a_dynamixel_is_recorded_in_the_units_of_its_model() {
    for (model, current_a) in [(1020, Some(2.0)), (1060, None)] {
        let mut device = dynamixel::servos(&[7], PERIOD_NS).unwrap();
        let mut drive = DynamixelSimulator::new(7, model, motor());
        let heard = ask(&mut device, 1.0, |time_s, bytes| drive.receive(time_s, bytes), |_, answer| answer);
        let rows = rows(&heard);
        // The first question is for the model.
        assert!((995..=1000).contains(&rows.len()) && drive.commands == 0, "{}", rows.len());
        let row = rows[900];
        assert!((row.values[1] - 12.5).abs() < 0.013, "{row:?}");
        assert_eq!((row.values[3], row.values[4], row.values[5]), (24.0, 308.15, 0.0));
        let expected = 12.5 * (row.arrival_ns - row.spread_ns) as f64 * 1e-9;
        assert!((row.values[0] - expected).abs() < 0.01, "{} for {expected}", row.values[0]);
        match current_a {
            Some(current_a) => assert!((row.values[2] - current_a).abs() < 2e-3, "{row:?}"),
            None => {
                assert!(row.values[2].is_nan());
                assert!(
                    heard
                        .iter()
                        .any(|heard| matches!(heard, Heard::Talk(text) if text.contains("model 1060")))
                );
            }
        }
    }
    let mut device = dynamixel::servos(&[7], PERIOD_NS).unwrap();
    let mut drive = DynamixelSimulator::new(7, 1020, motor());
    drive.error = 0x80;
    let damage = |turn: usize, mut answer: Vec<u8>| {
        if turn == 50 {
            answer[12] ^= 4;
        }
        answer
    };
    let heard = ask(&mut device, 0.2, |time_s, bytes| drive.receive(time_s, bytes), damage);
    assert_eq!(heard.iter().filter(|heard| matches!(heard, Heard::Fault(_))).count(), 1);
    assert!(heard.contains(&Heard::Damaged("the checksum of a packet is wrong")));
}

/// What a bus answers to bytes at a time, s.
type Answer<'b> = Box<dyn FnMut(f64, &[u8]) -> Vec<u8> + 'b>;

/// Several servos are one row; one that is unplugged leaves missing values, and the others stay.
#[test]
fn servos_of_one_bus_are_recorded_by_one_question() {
    let ids = [3, 1, 9];
    let mut dynamixels = ids.map(|id| DynamixelSimulator::new(id, 1020, turning(f64::from(id))));
    let mut feetechs = ids.map(|id| FeetechSimulator::new(id, turning(0.5 * f64::from(id))));
    feetechs[0].echoes = true;
    // The third Feetech counts its speed in 50 steps a second, and measures no current.
    feetechs[2].phase = 0x20;
    let (mut first, mut second) = (0, 0);
    let mut bus: [(Servos, usize, Answer<'_>); 2] = [
        (
            dynamixel::servos(&ids, PERIOD_NS).unwrap(),
            6,
            Box::new(|time_s, bytes| {
                first += 1;
                let is_unplugged = (400..500).contains(&first);
                let there = dynamixels.iter_mut().take(if is_unplugged { 2 } else { 3 });
                there.flat_map(|servo| servo.receive(time_s, bytes)).collect()
            }),
        ),
        (
            feetech::servos(&ids, PERIOD_NS).unwrap(),
            7,
            Box::new(|time_s, bytes| {
                second += 1;
                let is_unplugged = (400..500).contains(&second);
                let there = feetechs.iter_mut().take(if is_unplugged { 2 } else { 3 });
                there.flat_map(|servo| servo.receive(time_s, bytes)).collect()
            }),
        ),
    ];
    for (device, width, answer) in &mut bus {
        let heard = ask(device, 8.0, |time_s, bytes| answer(time_s, bytes), |_, answer| answer);
        let rows = rows(&heard);
        assert_eq!(device.channels()[*width].name, "servo1_position");
        assert_eq!(device.channels().len(), 3 * *width);
        // A hundred questions waited 70 ms for the third servo; the three first ones were for facts.
        assert!((1090..=1110).contains(&rows.len()), "{}", rows.len());
        for row in &rows {
            let parts: Vec<&[f64]> = row.values.chunks(*width).collect();
            let factor = if *width == 6 { 1.0 } else { 0.5 };
            let is_near = |part: &[f64], id: f64, step: f64| (part[1] - factor * id).abs() < step;
            assert!(is_near(parts[0], 3.0, 0.03) && is_near(parts[1], 1.0, 0.03), "{row:?}");
            assert!(is_near(parts[2], 9.0, 0.08) || parts[2].iter().all(|value| value.is_nan()), "{row:?}");
        }
        let without = rows.iter().filter(|row| row.values[2 * *width].is_nan()).count();
        assert_eq!(without, 100);
        let faults: Vec<_> = heard.iter().filter(|heard| matches!(heard, Heard::Fault(_))).collect();
        assert!(
            matches!(faults[..], [Heard::Fault(text)] if text.contains(" 9 does not answer")),
            "{faults:?}"
        );
        assert!(!heard.iter().any(|heard| matches!(heard, Heard::Damaged(_))));
    }
    drop(bus);
    assert!(
        dynamixels.iter().all(|servo| servo.commands == 0)
            && feetechs.iter().all(|servo| servo.commands == 0)
    );
}

#[test]
fn a_feetech_is_recorded_in_the_units_that_it_states() {
    let mut device = feetech::servos(&[4], PERIOD_NS).unwrap();
    let mut drive = FeetechSimulator::new(4, turning(-1.5));
    drive.error = 0x24;
    let heard = ask(&mut device, 1.0, |time_s, bytes| drive.receive(time_s, bytes), |_, answer| answer);
    let row = rows(&heard)[500];
    let expected = -1.5 * (row.arrival_ns - row.spread_ns) as f64 * 1e-9;
    assert!(
        (row.values[0] - expected).abs() < 2e-3 && (row.values[1] + 1.5).abs() < 1e-3,
        "{row:?} {expected}"
    );
    assert!((row.values[2] + 0.25).abs() < 1e-12 && (row.values[3] - 2.0).abs() < 4e-3, "{row:?}");
    assert_eq!(row.values[4..], [24.0, 308.15, 36.0]);
    assert!(heard.contains(&Heard::Fault("the Feetech 4 reports too high a temperature, overload".into())));
    let is_told = |heard: &Heard| matches!(heard, Heard::Talk(text) if text.contains("is model 777; its homing offset is 0"));
    assert!(heard.iter().any(is_told), "{:?}", heard[0]);

    let refusal = |change: fn(&mut FeetechSimulator)| {
        let (mut device, mut drive) =
            (feetech::servos(&[4], PERIOD_NS).unwrap(), FeetechSimulator::new(4, motor()));
        change(&mut drive);
        let (mut now_ns, mut heard) = (0, Vec::new());
        loop {
            let mut question = Vec::new();
            match device.poll(now_ns, &mut question) {
                Ok(next_ns) => now_ns = next_ns.unwrap(),
                Err(error) => return error.to_string(),
            }
            assert!(now_ns < 10_000_000_000, "never refused");
            let answer = drive.receive(0.0, &question);
            device.receive(Chunk { bytes: &answer, from_ns: now_ns, until_ns: now_ns }, &mut heard);
        }
    };
    assert!(refusal(|drive| drive.byte_order = 1).contains("only servos of the STS and SMS series"));
    assert!(refusal(|drive| drive.id = 5).contains("the Feetech 4 does not answer"));
}

#[test]
fn lost_and_damaged_answers_are_counted() {
    let mut device = Moteus::new(1, PERIOD_NS).unwrap();
    let mut drive = MoteusSimulator::new(1, motor());
    let damage = |turn: usize, answer: Vec<u8>| match turn {
        500 => Vec::new(),
        600 => answer[..answer.len() / 2].iter().copied().chain(*b"\n").collect(),
        700 => b"rcv 0100 ZZ E B F\r\n".to_vec(),
        _ => answer,
    };
    let heard = ask(&mut device, 1.0, |time_s, bytes| drive.receive(time_s, bytes), damage);
    let damaged = heard.iter().filter(|heard| matches!(heard, Heard::Damaged(_))).count();
    assert!((3..=6).contains(&damaged), "{damaged}");
    assert!(rows(&heard).iter().all(|row| row.values[3] == 0.25 && row.values[5] == 24.0));
}

#[test]
fn drives_that_cannot_be_are_refused() {
    assert!(Moteus::new(0, 1).is_err() && Moteus::new(200, 1).is_err() && Odrive::new(2, 1).is_err());
    let refusal =
        |ids: &[u8]| dynamixel::servos(ids, 1).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(refusal(&[253]).contains("253 is no number of a Dynamixel; expected numbers from 0 to 252"));
    assert!(refusal(&[1, 2, 1]).contains("a servo is named twice"));
    assert!(feetech::servos(&[254], 1).is_err() && feetech::servos(&[], 1).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_bytes_of_a_drive_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..200), digits in "[0-9A-F]{0,140}") {
        for device in [
            &mut Moteus::new(1, 1).unwrap() as &mut dyn Device,
            &mut Odrive::new(0, 1).unwrap(),
            &mut dynamixel::servos(&[1, 2], 1).unwrap(),
            &mut feetech::servos(&[1, 2], 1).unwrap(),
        ] {
            for bytes in [bytes.clone(), [[0xff, 0xff, 0xfd, 0, 1].as_slice(), &bytes].concat(), [[0xff, 0xff, 1, 34].as_slice(), &bytes].concat(), format!("\nrcv 0100 {digits} E B F\n{digits} 1\n2\n3\n4\n").into_bytes()] {
                let mut heard = Vec::new();
                device.receive(Chunk { bytes: &bytes, from_ns: 0, until_ns: 1 }, &mut heard);
                for row in rows(&heard) {
                    prop_assert_eq!(row.values.len(), device.channels().len());
                }
            }
        }
    }
}
