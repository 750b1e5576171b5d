//! The virtual board over its wire protocol.

use socam_core::{Request, Sample, State};
use socam_model::Model;
use socam_recording::{Calibration, ProfileFile};
use socam_sim::{Setup, Truth, VirtualBoard, calibration_for};
use socam_wire::{Decoder, Encoder, MAX_FRAME, ToBoard, ToHost};

/// A minimal host that can run a bench.
struct Host<'h, 'b> {
    board: &'h mut VirtualBoard<'b>,
    encoder: Encoder,
    decoder: Decoder<ToHost>,
    samples: Vec<Sample>,
    answers: u16,
    sent: u16,
}

impl<'h, 'b> Host<'h, 'b> {
    fn new(board: &'h mut VirtualBoard<'b>) -> Self {
        Self {
            board,
            encoder: Encoder::new(),
            decoder: Decoder::new(),
            samples: Vec::new(),
            answers: 0,
            sent: 0,
        }
    }

    fn ask(&mut self, request: Request) {
        self.sent += 1;
        let mut frame = [0; MAX_FRAME];
        let len = self.encoder.encode(&ToBoard::Request { number: self.sent, request }, &mut frame).unwrap();
        let mut bytes = Vec::new();
        self.board.receive(&frame[..len], &mut bytes);
        self.hear(&bytes);
        assert_eq!(self.answers, self.sent);
    }

    fn wait(&mut self, us: u64) {
        let until_us = self.board.now_us() + us;
        let mut bytes = Vec::new();
        self.board.advance(until_us, &mut bytes).unwrap();
        self.hear(&bytes);
    }

    fn hear(&mut self, bytes: &[u8]) {
        let mut rest = bytes;
        while let Some(item) = self.decoder.next(&mut rest) {
            match item.unwrap() {
                ToHost::Samples(batch) => self.samples.extend(batch.samples()),
                ToHost::Answer { number, result } => {
                    result.unwrap();
                    self.answers = number;
                }
                ToHost::Hello(_) | ToHost::Status(_) => {}
            }
        }
    }

    fn start(&mut self, calibration: &Calibration, profile: &str, period_us: u32) {
        let profile = ProfileFile::open(profile).unwrap().profile(period_us).unwrap();
        self.ask(Request::Configure(calibration.config(period_us).unwrap()));
        self.ask(Request::Load(profile));
        self.ask(Request::Arm);
        self.ask(Request::Stream(true));
        self.ask(Request::Run);
    }
}

fn record(model: &str, profile: &str, period_us: u32, seconds: u64, seed: u64) -> Vec<Sample> {
    let truth = Truth::new(&Model::builtin(model).unwrap(), &[], &[]).unwrap();
    let setup = Setup::new(truth.clone(), calibration_for(&truth.model), seed);
    VirtualBoard::run(&setup, |board| {
        let mut host = Host::new(board);
        host.start(&setup.calibration, profile, period_us);
        for _ in 0..seconds * 10 {
            host.wait(100_000);
            host.ask(Request::Heartbeat);
        }
        assert_eq!(host.board.state(), State::Running);
        host.samples
    })
    .unwrap()
}

#[test]
fn a_run_at_10_khz_is_complete_calibrated_and_repeatable() {
    let samples = record("speed-o-cam", "multisine", 100, 5, 1);
    assert!(samples.len() > 49_900, "{}", samples.len());
    assert!(
        samples.windows(2).all(|pair| pair[1].seq == pair[0].seq + 1 && pair[1].tick == pair[0].tick + 1)
    );

    let calibration = Calibration::default();
    let mut means = [0.0; 5];
    let whole = &samples[samples.len() - 20_000..];
    for sample in whole {
        let values = calibration.values(sample.output_count, &sample.counts[..4]);
        means.iter_mut().zip(values).for_each(|(mean, value)| *mean += value / whole.len() as f64);
    }
    // One period of the multisine: the means are the offset's steady state. c5 alone brakes.
    assert!((means[0] - 1.2).abs() < 2e-3, "{means:?}");
    let motor = calibration.motor.speed_rad_s(1.2);
    assert!((means[1] / motor - 1.0).abs() < 0.01, "{means:?}");
    assert!((means[1] / means[2] - 8.0).abs() < 0.01, "{means:?}");
    assert!((means[4] - 0.05 * means[2]).abs() < 0.01, "{means:?}");
    assert!((means[3] - means[4] / 8.0).abs() < 0.002, "{means:?}");

    assert_eq!(samples, record("speed-o-cam", "multisine", 100, 5, 1));
    let other = record("speed-o-cam", "multisine", 100, 5, 2);
    let differing = samples.iter().zip(&other).filter(|(a, b)| a.counts != b.counts).count();
    assert!(differing > 40_000, "{differing}");
}

#[test]
fn a_silent_host_and_a_stop_end_the_run() {
    let truth = Truth::new(&Model::builtin("speed-o-cam").unwrap(), &[], &[]).unwrap();
    let setup = Setup::new(truth, Calibration::default(), 0);
    let states = VirtualBoard::run(&setup, |board| {
        let mut host = Host::new(board);
        host.start(&setup.calibration, "steps", 1000);
        host.wait(400_000);
        host.ask(Request::Stop);
        host.wait(300_000);
        let stopped = host.board.state();
        host.ask(Request::Arm);
        host.ask(Request::Run);
        host.wait(600_000);
        (stopped, host.board.state())
    });
    assert_eq!(states.unwrap(), (State::Idle, State::Fault));
}

#[test]
fn benches_without_a_shaft_run_too() {
    for model in ["two-mass", "emps", "emps-loop", "gearmotor"] {
        let samples = record(model, "triangle", 1000, 2, 3);
        assert!(samples.iter().any(|sample| sample.counts[1] != 0), "{model}");
    }
}
