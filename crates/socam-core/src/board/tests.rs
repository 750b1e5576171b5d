use super::*;
use crate::ring::Ring;
use crate::{ChannelKind, ConverterSilent, Profile, Request, Shape};

#[derive(Default)]
struct Still {
    now_us: u64,
    enabled: bool,
    output: i16,
}

impl Ports for Still {
    type Count = i16;

    fn now_us(&mut self) -> u64 {
        self.now_us
    }

    fn read(&mut self, counts: &mut [i16]) -> Result<(), ConverterSilent> {
        counts.fill(0);
        Ok(())
    }

    fn write(&mut self, count: i16) -> Result<(), ConverterSilent> {
        self.output = count;
        Ok(())
    }

    fn enable(&mut self, on: bool) {
        self.enabled = on;
    }
}

fn profile() -> Profile {
    Profile {
        command: Command::Voltage,
        shape: Shape::Constant { level_micro: 400_000 },
        ramp_us: 0,
        limit_micro: 400_000,
        slew_micro_s: 400_000_000,
        duration_us: 1_000_000,
    }
}

/// Flips a bit of a field of the configuration.
type Flip = fn(&mut Config, u32);

/// Fields of every kind, with their width in bits. The emulated board flips all the memory (`tests/tests/board_memory.rs`).
const FIELDS: [(u32, Flip); 14] = [
    (32, |c, bit| c.sample_period_us ^= 1 << bit),
    (8, |c, bit| c.channel_count ^= 1 << bit),
    (64, |c, bit| c.output.counts_per_uv_q32 ^= 1 << bit),
    (32, |c, bit| c.output.clamp_uv ^= 1 << bit),
    (64, |c, bit| c.speed.motor.uv_per_urad_s_q32 ^= 1 << bit),
    (32, |c, bit| c.speed.motor.offset_uv ^= 1 << bit),
    (8, |c, bit| c.speed.tachometer ^= 1 << bit),
    (64, |c, bit| c.speed.proportional_q32 ^= 1 << bit),
    (64, |c, bit| c.channels[7].scale.micro_per_count_q16 ^= 1 << bit),
    (32, |c, bit| c.channels[0].scale.offset_micro ^= 1 << bit),
    (32, |c, bit| c.channels[0].limit_micro = c.channels[0].limit_micro.map(|limit| limit ^ 1 << bit)),
    (1, |c, _| c.channels[3].limit_micro = None),
    (1, |c, _| c.channels[3].kind = ChannelKind::Speed),
    (32, |c, bit| c.host_timeout_us ^= 1 << bit),
];

const PROFILE_FIELDS: [fn(&mut Profile); 4] = [
    |profile| profile.command = Command::SpeedOpenLoop,
    |profile| profile.shape = Shape::Constant { level_micro: 400_001 },
    |profile| profile.slew_micro_s ^= 1 << 31,
    |profile| profile.duration_us ^= 1 << 63,
];

#[test]
fn every_bit_that_flips_in_the_configuration_cuts_the_output_at_the_next_tick() {
    let mut ring = Ring::<i16, 4>::new();
    let mut board = Board::new(Still::default(), ring.split().0);
    for request in [Request::Load(profile()), Request::Arm, Request::Run] {
        board.handle(request).unwrap();
    }
    board.tick();
    assert!(board.ports.enabled && board.ports.output == 1311);
    let (config, state, generator, loaded) = (board.config, board.state, board.generator, board.loaded);
    for (width, flip) in FIELDS {
        for bit in 0..width {
            board.config.edit(|config| flip(config, bit));
            board.tick();
            assert_eq!(
                (board.fault, board.ports.enabled, board.ports.output),
                (Some(Fault::Corrupted), false, 0)
            );
            (board.config, board.state, board.generator, board.fault) = (config, state, generator, None);
            board.tick();
            assert!(board.ports.enabled && board.fault.is_none());
        }
    }
    // The profile states whether the setpoint is in volts, or is a speed that the motor's calibration converts to volts.
    for flip in PROFILE_FIELDS {
        board.loaded.edit(|profile| flip(profile.as_mut().unwrap()));
        board.tick();
        assert_eq!(
            (board.fault, board.ports.enabled, board.ports.output),
            (Some(Fault::Corrupted), false, 0)
        );
        (board.loaded, board.state, board.generator, board.fault) = (loaded, state, generator, None);
        board.tick();
        assert!(board.ports.enabled && board.fault.is_none());
    }
    board.state.edit(|state| *state = State::Stopping);
    board.tick();
    assert_eq!((board.fault, board.ports.enabled), (Some(Fault::Corrupted), false));
}

/// At rest a broken configuration commands nothing; it does not arm, and a new one replaces it.
#[test]
fn a_broken_configuration_never_arms() {
    let mut ring = Ring::<i16, 4>::new();
    let mut board = Board::new(Still::default(), ring.split().0);
    board.handle(Request::Load(profile())).unwrap();
    board.config.edit(|config| config.output.clamp_uv ^= 1 << 23);
    board.tick();
    for request in [Request::Arm, Request::Run] {
        let _ = board.handle(request);
        board.tick();
        assert!(!board.ports.enabled);
    }
    for request in [
        Request::ClearFault,
        Request::Configure(Config::default()),
        Request::Load(profile()),
        Request::Arm,
        Request::Run,
    ] {
        board.handle(request).unwrap();
    }
    board.tick();
    assert!(board.ports.enabled);
}
