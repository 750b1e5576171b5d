use proptest::prelude::*;

use super::*;
use crate::timeline::{Placed, Timeline};

fn description(lines: &str, more: &str) -> Description {
    Description::parse(&format!("[lines]\n{lines}\n{more}")).unwrap()
}

fn csv() -> Description {
    let channels = "[clock]\nsignal = \"t\"\nunit = \"ms\"\n[channels.speed]\nsignal = \"n\"\nunit = \"rpm\"\n\
        [channels.torque]\nsignal = \"m\"\nunit = \"N m\"\n";
    description("form = \"csv\"\nnames = [\"t\", \"n\", \"m\"]", channels)
}

fn hear(device: &mut TextDevice, bytes: &[u8]) -> Vec<Heard> {
    let mut heard = Vec::new();
    device.receive(Chunk { bytes, from_ns: 0, until_ns: 1_000_000 }, &mut heard);
    heard
}

fn rows(heard: &[Heard]) -> Vec<&Row> {
    heard.iter().filter_map(|heard| if let Heard::Row(row) = heard { Some(row) } else { None }).collect()
}

#[test]
fn columns_become_rows_in_si() {
    let mut device = TextDevice::new(csv(), Bounds::Ends);
    // The beginning of the first line was not seen.
    let heard = hear(&mut device, b"9,5\nt,n,m\nready\n1,60,0.5\r\n2,120,\n3,nan,0.25\n");
    assert_eq!(heard[0], Heard::Talk("ready".into()));
    let rows = rows(&heard);
    assert_eq!(rows.len(), 3);
    assert_eq!((rows[0].device_s, rows[0].values[1]), (Some(0.001), 0.5));
    assert!((rows[0].values[0] - std::f64::consts::TAU).abs() < 1e-12 && rows[1].values[1].is_nan());
    assert!(rows[2].values[0].is_nan());
}

/// What must never become a row, and the one reason that is given.
#[test]
fn damaged_lines_are_no_rows() {
    for line in [
        "1,60",
        "1,60,0.5,7",
        "1,60,0.5x",
        "1,1e999,0.5",
        "x,60,0.5",
        "1,60,2,5",
        ",60,0.5",
        "1,6\u{fffd}0,0.5",
    ] {
        let mut device = TextDevice::new(csv(), Bounds::Ends);
        let heard = hear(&mut device, format!("\n{line}\n").as_bytes());
        assert!(matches!(heard[..], [Heard::Damaged(_)]), "{line}: {heard:?}");
    }
    let mut device = TextDevice::new(csv(), Bounds::Ends);
    assert_eq!(hear(&mut device, b"\n1,60,\xff0.5\n"), [Heard::Damaged("a line is no UTF-8 text")]);
    let long = [b"\n".to_vec(), b"1".repeat(100_000), b"\n1,60,0.5\n".to_vec()].concat();
    let heard = hear(&mut device, &long);
    assert!(
        matches!(heard[..], [Heard::Damaged("a line is longer than 65536 bytes"), Heard::Row(_)]),
        "{heard:?}"
    );
    // The cable is pulled within a line, and put in again within another.
    let mut heard = hear(&mut device, b"2,60,0.");
    device.interrupted(&mut heard);
    heard.extend(hear(&mut device, b"60,0.5\n4,60,0.75\n"));
    assert!(matches!(&heard[..], [Heard::Damaged(_), Heard::Row(row)] if row.values[1] == 0.75), "{heard:?}");
}

/// Over TCP a header comes first; numbers whose beginning was not seen are no row.
#[test]
fn the_first_line_of_a_connection_is_believed_if_it_is_a_header() {
    let lines: Vec<String> =
        std::iter::once("t_ms,a_V\n".to_owned()).chain((0..50).map(|k| format!("{},1\n", 10 * k))).collect();
    let found = probe(&chunks(&lines), Bounds::Connected, false).unwrap();
    assert_eq!(found.description().unwrap().channels()[0].column_name(), "a_V");
    let mut device = TextDevice::new(found.description().unwrap(), Bounds::Connected);
    assert_eq!(rows(&hear(&mut device, b"0,1\n20,1\n")).len(), 1);
}

#[test]
fn pairs_and_records_are_read() {
    let channels = "[channels.speed]\nsignal = \"speed\"\nunit = \"rad/s\"\n[channels.torque]\nsignal = \"torque\"\nunit = \"N m\"\n";
    for text in [
        "speed:1.5,torque:0.25\n",
        "speed=1.5 torque=0.25\n",
        "speed: 1.5 torque: 0.25\n",
        "torque:0.25\tspeed:1.5\tother:3\n",
        ">speed:1.5\n>torque:0.25\n",
    ] {
        let mut device = TextDevice::new(description("form = \"pairs\"", channels), Bounds::Ends);
        let heard = hear(&mut device, format!("\n{text}").as_bytes());
        assert_eq!(
            rows(&heard).iter().map(|row| row.values.clone()).collect::<Vec<_>>(),
            [[1.5, 0.25]],
            "{text}"
        );
    }
    let nested = "[channels.speed]\nsignal = \"motor.speed\"\nunit = \"rad/s\"\n[channels.torque]\nsignal = \"m.1\"\nunit = \"N m\"\n";
    let mut device = TextDevice::new(description("form = \"json\"", nested), Bounds::Chunks);
    let heard = hear(&mut device, br#"{"motor":{"speed":1.5},"m":[9,0.25],"name":"x"}"#);
    assert_eq!(rows(&heard)[0].values, [1.5, 0.25]);
    assert_eq!(
        hear(&mut device, br#"{"motor":{"speed":1.5},"m":[9,"#),
        [Heard::Damaged("a line is no whole JSON record")]
    );
    let heard = hear(&mut device, br#"{"motor":{"speed":"fast"},"m":[9,0.25]}"#);
    assert_eq!(heard, [Heard::Damaged("text stands in the place of a number")]);
}

#[test]
fn an_encoder_that_begins_anew_goes_on() {
    let text = "[channels.angle]\nsignal = \"e\"\nunit = \"counts\"\ncounts_per_turn = 4096\nwrap = 65536\n";
    let mut device = TextDevice::new(description("form = \"pairs\"", text), Bounds::Ends);
    let heard = hear(&mut device, b"\ne:65000\ne:500\ne:65500\n");
    let counts: Vec<f64> =
        rows(&heard).iter().map(|row| (row.values[0] * 4096.0 / std::f64::consts::TAU).round()).collect();
    assert_eq!(counts, [65_000.0, 66_036.0, 65_500.0]);
}

/// Chunks of lines that arrive every 10 ms.
fn chunks(lines: &[String]) -> Vec<Chunk<'_>> {
    let ends_ns = (1..).map(|k| 10_000_000 * k);
    let chunk = |(line, until_ns)| {
        let line: &String = line;
        Chunk { bytes: line.as_bytes(), from_ns: until_ns - 10_000_000, until_ns }
    };
    lines.iter().zip(ends_ns).map(chunk).collect()
}

#[test]
fn a_device_that_states_everything_needs_no_file() {
    let line = |k: usize| format!("{},{},{}\n", 10 * k, k, 0.5 * k as f64);
    let lines: Vec<String> = ["x\n", "t_ms,seq,motor_speed_rpm\n"]
        .map(String::from)
        .into_iter()
        .chain((0..100).map(line))
        .collect();
    let found = probe(&chunks(&lines), Bounds::Ends, false).unwrap();
    assert_eq!(found.unknown, [""; 0], "{}", found.text);
    let description = found.description().unwrap();
    assert_eq!(
        description.clock.as_ref().map(|clock| (clock.signal.as_str(), clock.unit_s)),
        Some(("t_ms", 1e-3))
    );
    assert_eq!(description.number, Some(("seq".into(), 0)));
    assert_eq!(description.channels()[0].column_name(), "motor_speed_rad_s");
    // The rest of the stream has no other time than the device says.
    let mut timeline = Timeline::new(Numbering::Numbered(0), None);
    let mut device = TextDevice::new(description, Bounds::Ends);
    let (mut heard, mut last) = (Vec::new(), None);
    chunks(&lines).into_iter().for_each(|chunk| device.receive(chunk, &mut heard));
    for row in rows(&heard) {
        last = Some(timeline.place(row));
    }
    assert_eq!(last, Some(Placed::At { time_ns: 990_000_000, sequence: 99, jumped: false }));
}

#[test]
fn what_a_device_does_not_state_is_asked() {
    let line = |k: usize| format!("{}\t{}\t{}\n", 7_000_000 + 10_000 * k, k % 7, 0.25 * k as f64);
    let lines: Vec<String> = (0..100).map(line).collect();
    let found = probe(&chunks(&lines), Bounds::Ends, false).unwrap();
    assert_eq!(found.unknown, ["the unit of `column 2`", "the unit of `column 3`"]);
    let plain = Description::parse(&found.plain).unwrap();
    let units: Vec<_> = plain.channels.iter().map(|channel| (channel.unit, channel.factor)).collect();
    assert_eq!(units, [(socam_units::Unit::One, 1.0); 2], "{}", found.plain);
    assert!(found.assumed[0].contains("`column 1` is the device's clock in us"), "{:?}", found.assumed);
    assert!(found.description().unwrap_err().to_string().contains("does not state the unit of `column 2`"));
    let complete = found.text.replace("\"?\"", "\"V\"");
    assert_eq!(Description::parse(&complete).unwrap().clock.unwrap().unit_s, 1e-6);

    let pair = |k: usize| format!("speed:{},torque:0.5,mode:3\n", k % 9);
    let lines: Vec<String> = (0..100).map(pair).collect();
    let found = probe(&chunks(&lines), Bounds::Ends, true).unwrap();
    assert_eq!(found.description().unwrap().channels.len(), 2, "{}", found.text);
    assert!(found.assumed.iter().any(|text| text.contains("`mode` is left out")), "{:?}", found.assumed);
}

#[test]
fn what_is_no_text_is_refused_in_one_sentence() {
    for bytes in
        [&b"\xff\xfe\x01\n\x80\x80\n\x90\n"[..], b"hello\nworld\nagain\nand again\n", b"12345", b"\n\n\n"]
    {
        let chunk = Chunk { bytes, from_ns: 0, until_ns: 1_000_000_000 };
        let sentence = probe(&[chunk], Bounds::Ends, false).unwrap_err().to_string();
        assert!(sentence.starts_with("none of the ") && !sentence.contains(". "), "{sentence}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// No bytes make it panic, and the division into reads changes nothing.
    #[test]
    fn any_bytes_are_survived(bytes in proptest::collection::vec(prop_oneof![any::<u8>(), "[0-9,.:;{}\"a-c\n-]".prop_map(|s| s.as_bytes()[0])], 0..300), at in 0usize..300) {
        let descriptions = [
            csv(),
            description("form = \"pairs\"", "[channels.a]\nsignal = \"a\"\nunit = \"V\"\nwrap = 10\n"),
            description("form = \"json\"", "[channels.a]\nsignal = \"a\"\nunit = \"V\"\n"),
        ];
        for description in descriptions {
            let mut whole = TextDevice::new(description.clone(), Bounds::Ends);
            let mut parts = TextDevice::new(description, Bounds::Ends);
            let (first, second) = bytes.split_at(at.min(bytes.len()));
            let values = |heard: &[Heard]| -> Vec<String> {
                heard.iter().map(|heard| match heard {
                    Heard::Row(row) => format!("{:?} {:?}", row.device_s, row.values),
                    other => format!("{other:?}"),
                }).collect()
            };
            let one = values(&hear(&mut whole, &bytes));
            let mut two = hear(&mut parts, first);
            two.extend(hear(&mut parts, second));
            prop_assert_eq!(one, values(&two));
        }
        let chunk = Chunk { bytes: &bytes, from_ns: 0, until_ns: 1_000_000_000 };
        if let Ok(found) = probe(&[chunk], Bounds::Ends, true)
            && found.unknown.is_empty()
        {
            prop_assert!(found.description().is_ok(), "{}", found.text);
        }
    }
}
