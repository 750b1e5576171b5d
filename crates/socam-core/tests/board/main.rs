//! The board on hardware with every failure that the ports allow.

mod bench;
mod motor;

use bench::{Bench, RING, attended, bench, constant, running, ticks};
use proptest::prelude::*;
use socam_core::{
    Board, Command, Config, Fault, Flags, MAX_CHANNELS, Profile, Refusal, Request, Ring, Sample, State,
};

#[test]
fn a_run_goes_from_zero_to_zero_and_every_sample_arrives() {
    let mut ring = Ring::new();
    let (producer, mut consumer) = ring.split();
    let mut board = Board::new(bench(), producer);
    assert!(!board.ports_mut().enabled && board.ports_mut().output == 0, "live before anyone asked");
    running(&mut board, constant(1_500_000, Command::Voltage));
    attended(&mut board, 3500);
    assert_eq!(board.status().state, State::Idle);
    assert_eq!((board.ports_mut().output, board.ports_mut().enabled), (0, false));

    let samples: Vec<Sample<i16>> = std::iter::from_fn(|| consumer.pop()).collect();
    assert!(samples.iter().enumerate().all(|(i, s)| s.seq == i as u32 && s.tick == 1 + i as u32));
    // 1.5 V at 20 V/s: 75 samples up, and down again after three seconds.
    assert_eq!(samples[74].output_count, 4915);
    assert_eq!(samples[3000].flags.state(), Some(State::Stopping));
    assert_eq!(samples[3074].flags.state(), Some(State::Idle));
    assert!(samples[0].flags.has(Flags::LIMITED) && !samples[2000].flags.has(Flags::LIMITED));
}

#[test]
fn closed_loop_holds_a_speed_that_open_loop_misses() {
    for (command, tolerance) in [(Command::SpeedOpenLoop, 2e6), (Command::SpeedClosedLoop, 2e4)] {
        let mut ring = Ring::new();
        let (producer, _consumer) = ring.split();
        let mut board = Board::new(bench(), producer);
        running(&mut board, constant(100_000_000, command));
        attended(&mut board, 2900);
        let error = (board.ports_mut().speed_urad_s - 100e6).abs();
        assert!(error < tolerance, "{command:?} is off by {error} urad/s");
        assert!(command == Command::SpeedClosedLoop || error > 5e4);
    }
}

#[test]
fn missed_ticks_are_counted_and_marked() {
    let mut ring = Ring::new();
    let (producer, mut consumer) = ring.split();
    let mut board = Board::new(bench(), producer);
    board.handle(Request::Stream(true)).unwrap();
    ticks(&mut board, 3);
    board.ports_mut().now_us += 2000;
    ticks(&mut board, 1);
    let marks: Vec<_> =
        std::iter::from_fn(|| consumer.pop()).map(|s| (s.tick, s.seq, s.flags.has(Flags::OVERRUN))).collect();
    assert_eq!(marks, [(1, 0, false), (2, 1, false), (3, 2, false), (6, 3, true)]);
    assert_eq!(board.status().overruns, 2);
}

/// Every fault, provoked while running: named, latched, and the output cut at the very next tick.
#[test]
fn each_fault_cuts_the_output_at_the_next_tick_and_is_named() {
    type Provoke = fn(&mut Board<'_, Bench, RING>);
    let cases: [(Provoke, u32, &str); 14] = [
        (|b| b.ports_mut().stop_pressed = true, 1, "emergency stop: the contact at the bench is open"),
        (|b| b.ports_mut().converter_silent = true, 1, "the input converter does not answer"),
        (|b| b.ports_mut().output_silent = true, 1, "the output converter does not answer"),
        (|b| b.ports_mut().forced[0] = Some(32_400), 1, "over-speed: motor_speed is 150.06"),
        (|b| b.ports_mut().forced[3] = Some(-31_500), 1, "over-torque: torque_out is -38.45"),
        (|b| b.ports_mut().forced[2] = Some(i16::MIN), 1, "torque_in is saturated: it reads -32768 counts"),
        (|b| b.ports_mut().forced = [Some(12_000); MAX_CHANNELS], 1, "all inputs read the same 12000 counts"),
        (|b| b.ports_mut().forced[2] = Some(77), 1001, "torque_in is stuck: it read 77 counts for 1000 ms"),
        (|b| b.ports_mut().codes = Some(100), 1, "torque_in is stuck: it read "),
        (|b| b.ports_mut().line_stuck = Some(false), 1, "the drive's enable line is low although the board"),
        (
            // The line is held high where the run ends, and that is noticed at the same tick.
            |b| {
                b.ports_mut().line_stuck = Some(true);
                b.handle(Request::Stop).unwrap();
            },
            75,
            "the drive's enable line is high although the board set it low",
        ),
        (
            |b| b.ports_mut().forced[0] = Some(9),
            500,
            "motor_speed is missing, or its shaft is locked: it reads 0.041",
        ),
        (|_| (), 501, "no word from the host for 500 ms"),
        (|b| b.handle(Request::EmergencyStop).unwrap(), 0, "emergency stop by the host"),
    ];
    let names = ["motor_speed", "output_speed", "torque_in", "torque_out"];
    for (provoke, after_ticks, sentence) in cases {
        let mut ring = Ring::new();
        let (producer, _consumer) = ring.split();
        let mut board = Board::new(bench(), producer);
        running(&mut board, constant(1_500_000, Command::Voltage));
        attended(&mut board, 1000);
        assert!(board.ports_mut().enabled && board.ports_mut().output > 4000);
        let unattended = sentence.starts_with("no word");
        if unattended {
            board.handle(Request::Heartbeat).unwrap();
        }
        provoke(&mut board);
        for tick in 1..=after_ticks {
            assert_eq!(board.status().fault, None, "{sentence}: at tick {tick} of {after_ticks}");
            assert_ne!(board.status().state, State::Idle, "{sentence}: taken for the end of the run");
            if !unattended {
                board.handle(Request::Heartbeat).unwrap();
            }
            ticks(&mut board, 1);
        }
        let fault = board.status().fault.expect(sentence);
        assert!(fault.with_names(&names).to_string().starts_with(sentence), "{}", fault.with_names(&names));
        assert!(!board.ports_mut().enabled, "{sentence}: still enabled");
        assert!(
            board.ports_mut().output == 0 || board.ports_mut().output_silent,
            "{sentence}: still at a voltage"
        );
        let latched = board.handle(Request::Arm);
        assert_eq!(latched, Err(Refusal::Faulted(fault)));

        *board.ports_mut() = bench();
        ticks(&mut board, 1);
        assert_eq!(board.status().fault, Some(fault), "{sentence}: forgot its cause");
        board.handle(Request::ClearFault).unwrap();
        board.handle(Request::Arm).unwrap();
    }
}

#[test]
fn an_enable_line_that_is_high_at_rest_is_a_fault_that_comes_back() {
    let mut ring = Ring::<i16, RING>::new();
    let (producer, _consumer) = ring.split();
    let mut board = Board::new(bench(), producer);
    board.ports_mut().line_stuck = Some(true);
    for _ in 0..2 {
        ticks(&mut board, 1);
        assert_eq!(board.status().fault, Some(Fault::EnableStuck { is_on: true }));
        board.handle(Request::ClearFault).unwrap();
    }
}

#[test]
fn nothing_asks_a_board_for_more_than_its_ceilings() {
    let mut ring = Ring::<i16, RING>::new();
    let (producer, _consumer) = ring.split();
    let mut board = Board::new(bench(), producer);
    let config = |change: fn(&mut Config)| {
        let mut config = Config::default();
        change(&mut config);
        Request::Configure(config)
    };
    let profile = |change: fn(&mut Profile)| {
        let mut profile = constant(100_000_000, Command::SpeedOpenLoop);
        change(&mut profile);
        Request::Load(profile)
    };
    for (request, says) in [
        (config(|c| c.output.clamp_uv = 5_000_001), "the output's clamp exceeds the 5.000 V"),
        (config(|c| c.sample_period_us = 100), "this board's sample period is 200 us to 10000 us"),
        (config(|c| c.sample_period_us = 20_000), "this board's sample period is 200 us to 10000 us"),
        (config(|c| c.channels = [socam_core::Channel::UNUSED; MAX_CHANNELS]), "no channel"),
        (profile(|p| p.duration_us = 10_000_001), "it lasts longer than the 10 s"),
        (profile(|p| p.limit_micro = 250_000_001), "its limit exceeds the 250.000 rad/s"),
    ] {
        let refusal = board.handle(request).unwrap_err().to_string();
        assert!(refusal.contains(says) || says == "no channel", "{refusal}");
    }
    // A slew limit stretches the fade-out of a profile of the longest duration beyond it.
    running(
        &mut board,
        Profile { duration_us: 10_000_000, slew_micro_s: 1_000_000, ..constant(1_500_000, Command::Voltage) },
    );
    attended(&mut board, 10_000);
    assert_eq!(board.status().fault, None);
    attended(&mut board, 100);
    assert_eq!(board.status().fault, Some(Fault::RunTooLong { limit_us: 10_000_000 }));
}

/// A profile ends after its number of ticks; where ticks come too slowly, the clock ends it.
#[test]
fn a_run_whose_ticks_are_slow_ends_by_the_clock() {
    let mut ring = Ring::<i16, RING>::new();
    let (producer, _consumer) = ring.split();
    let mut board = Board::new(bench(), producer);
    // The time limit of the profile is 3 s, with 0.075 s to slew down and 1 s to be late.
    running(&mut board, Profile { limit_micro: 1_500_000, ..constant(1_500_000, Command::Voltage) });
    let slow_tick = |board: &mut Board<'_, Bench, RING>| {
        board.handle(Request::Heartbeat).unwrap();
        board.ports_mut().now_us += 5_000;
        board.tick();
    };
    (0..815).for_each(|_| slow_tick(&mut board));
    assert!(board.ports_mut().enabled, "{:?}", board.status().fault);
    slow_tick(&mut board);
    assert_eq!(board.status().fault, Some(Fault::RunTooLong { limit_us: 4_075_000 }));
    assert_eq!((board.ports_mut().enabled, board.ports_mut().output), (false, 0));
}

#[test]
fn refusals_say_what_is_needed() {
    let mut ring = Ring::<i16, RING>::new();
    let (producer, _consumer) = ring.split();
    let mut board = Board::new(bench(), producer);
    assert_eq!(board.handle(Request::Arm), Err(Refusal::NoProfile));
    let refusal = board.handle(Request::Run).unwrap_err().to_string();
    assert_eq!(refusal, "the board is idle; it must be armed for this");
    let wild = constant(2_000_000_000, Command::Voltage);
    assert!(
        board
            .handle(Request::Load(wild))
            .unwrap_err()
            .to_string()
            .starts_with("profile refused: the command reaches")
    );
    running(&mut board, constant(1_000_000, Command::Voltage));
    assert!(board.handle(Request::Configure(Config::default())).is_err());
}

#[derive(Debug, Clone)]
enum Event {
    Ask(Box<Request>),
    Ticks(u32),
    Silence(u64),
    Converter(bool),
    Output(bool),
    StopInput(bool),
    Force(usize, Option<i16>),
}

fn any_event() -> impl Strategy<Value = Event> {
    let profile = (any::<i32>(), 0..3usize, 1..2_000_000u64, 0..100_000u32).prop_map(
        |(level, command, duration_us, ramp_us)| {
            let command = [Command::Voltage, Command::SpeedOpenLoop, Command::SpeedClosedLoop][command];
            Profile { duration_us, ramp_us, limit_micro: i32::MAX, ..constant(level >> (level & 7), command) }
        },
    );
    let config = (0..3_000_000u32, 0..12u8, any::<i64>(), 0..20_000_000i32).prop_map(
        |(period, channels, gain, clamp_uv)| {
            let mut config =
                Config { sample_period_us: period, channel_count: channels, ..Config::default() };
            config.channels[1].scale.micro_per_count_q16 = gain >> (gain & 63);
            config.output.clamp_uv = clamp_uv;
            config
        },
    );
    prop_oneof![
        2 => Just(Event::Ask(Box::new(Request::Heartbeat))),
        2 => profile.prop_map(|p| Event::Ask(Box::new(Request::Load(p)))),
        1 => config.prop_map(|c| Event::Ask(Box::new(Request::Configure(c)))),
        3 => Just(Event::Ask(Box::new(Request::Arm))),
        4 => Just(Event::Ask(Box::new(Request::Run))),
        1 => Just(Event::Ask(Box::new(Request::Stop))),
        1 => Just(Event::Ask(Box::new(Request::EmergencyStop))),
        2 => Just(Event::Ask(Box::new(Request::ClearFault))),
        1 => any::<bool>().prop_map(|on| Event::Ask(Box::new(Request::Stream(on)))),
        6 => (1..200u32).prop_map(Event::Ticks),
        1 => (0..2_000_000u64).prop_map(Event::Silence),
        1 => any::<bool>().prop_map(Event::Converter),
        1 => any::<bool>().prop_map(Event::Output),
        1 => any::<bool>().prop_map(Event::StopInput),
        2 => (0..MAX_CHANNELS, any::<Option<i16>>()).prop_map(|(c, v)| Event::Force(c, v)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    /// After any sequence of requests, pauses and hardware failures the output is live only when running or stopping, and within
    /// its clamp.
    #[test]
    fn the_output_is_live_only_where_it_may_be(events in prop::collection::vec(any_event(), 1..60)) {
        let mut ring = Ring::<i16, RING>::new();
        let (producer, _consumer) = ring.split();
        let mut board = Board::new(bench(), producer);
        let mut cause: Option<Fault> = None;
        for event in events {
            let mut ticked = 0;
            match event {
                Event::Ask(request) => {
                    let _ = board.handle(*request);
                    if *request == Request::ClearFault {
                        cause = None;
                    }
                }
                Event::Ticks(count) => ticked = count,
                Event::Silence(us) => board.ports_mut().now_us += us,
                Event::Converter(silent) => board.ports_mut().converter_silent = silent,
                Event::Output(silent) => board.ports_mut().output_silent = silent,
                Event::StopInput(pressed) => board.ports_mut().stop_pressed = pressed,
                Event::Force(channel, count) => board.ports_mut().forced[channel] = count,
            }
            for step in 0..=ticked {
                if step > 0 {
                    ticks(&mut board, 1);
                }
                let status = board.status();
                let clamp = board.config().output.count(board.config().output.clamp_uv);
                let ports = board.ports_mut();
                prop_assert_eq!(status.state == State::Fault, status.fault.is_some());
                prop_assert!(status.state.is_live() || !ports.enabled);
                if step > 0 {
                    prop_assert_eq!(ports.enabled, status.state.is_live());
                    prop_assert!(status.state.is_live() || ports.output_silent || ports.output == 0);
                }
                prop_assert!(ports.output.abs() <= clamp || ports.output_silent);
                if ports.converter_silent && step > 0 {
                    prop_assert_eq!(status.state, State::Fault);
                }
                // The first cause stays until it is cleared.
                prop_assert!(cause.is_none() || cause == status.fault);
                cause = status.fault;
            }
        }
    }
}
