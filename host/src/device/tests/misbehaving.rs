//! Boards that do not keep to the protocol.

use std::collections::VecDeque;

use socam_core::{Flags, Layout, MAX_CHANNELS, Refusal, Sample, State};
use socam_wire::{
    BoardKind, Decoder, EnableFeedback, Encoder, FrontEnd, Identity, Image, MAX_FRAME, SampleBatch, Start,
    Text, ToBoard, ToHost,
};

use super::*;

/// A board of four channels that answers every request and streams without an end.
struct Endless {
    decoder: Decoder<ToBoard>,
    encoder: Encoder,
    outgoing: VecDeque<u8>,
    state: State,
    tick: u32,
    /// Whether it obeys a request to stop.
    stops: bool,
    /// Whether it starts.
    runs: bool,
    /// Changes samples: tick and number of channels.
    change: fn(u32) -> (u32, u8),
}

impl Endless {
    fn new(stops: bool, change: fn(u32) -> (u32, u8)) -> Self {
        Self {
            decoder: Decoder::new(),
            encoder: Encoder::new(),
            outgoing: VecDeque::new(),
            state: State::Armed,
            tick: 0,
            stops,
            runs: true,
            change,
        }
    }

    fn send(&mut self, message: &ToHost) {
        let mut frame = [0; MAX_FRAME];
        let length = self.encoder.encode(message, &mut frame).unwrap();
        self.outgoing.extend(&frame[..length]);
    }
}

impl Write for Endless {
    fn write(&mut self, mut bytes: &[u8]) -> io::Result<usize> {
        let written = bytes.len();
        while let Some(message) = self.decoder.next(&mut bytes) {
            match message.unwrap() {
                ToBoard::Hello => self.send(&ToHost::Hello(Identity {
                    board: Text::new("endless"),
                    firmware: Text::new("0"),
                    front_end: FrontEnd {
                        kind: BoardKind::Analog,
                        input_full_scale_uv: 10_000_000,
                        output_full_scale_uv: 10_000_000,
                        channel_step_ns: 0,
                    },
                    start: Start::Supply,
                    enable_feedback: EnableFeedback::Nowhere,
                    image: Image::Whole,
                })),
                ToBoard::Request { number, request } => {
                    self.state = match request {
                        Request::Run => State::Running,
                        Request::Stop if self.stops => State::Idle,
                        _ => self.state,
                    };
                    let result = match request {
                        Request::Run if !self.runs => Err(Refusal::NoProfile),
                        _ => Ok(()),
                    };
                    self.send(&ToHost::Answer { number, result });
                }
            }
        }
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Endless {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.outgoing.is_empty() {
            for _ in 0..100 {
                let (tick, channels) = (self.change)(self.tick);
                let sample = Sample {
                    tick,
                    counts: [1000; MAX_CHANNELS],
                    flags: Flags::new(self.state),
                    ..Sample::default()
                };
                self.tick += 1;
                self.send(&ToHost::Samples(SampleBatch::new(&sample, Layout::narrow(channels))));
            }
        }
        let count = buffer.len().min(self.outgoing.len());
        for (to, from) in buffer.iter_mut().zip(self.outgoing.drain(..count)) {
            *to = from;
        }
        Ok(count)
    }
}

#[test]
fn a_board_that_does_not_end_its_profile_is_stopped_and_given_up() {
    let calibration = Calibration::default();
    for (stops, words) in [(true, "so the host stopped it"), (false, "does not stop")] {
        let (report, data) = run_on(Box::new(Endless::new(stops, |tick| (tick, 4))), &calibration);
        let End::Broken(reason) = report.unwrap().end else { panic!("it is said to have ended") };
        assert!(reason.contains(words), "{reason}");
        let data = data.unwrap();
        assert!((3000..20_000).contains(&data.rows()), "{}", data.rows());
        assert!(
            data.contents().unwrap().events.iter().any(|event| event.text.contains("longer than planned"))
        );
    }
}

#[test]
fn samples_of_another_number_of_channels_are_lost_and_shift_nothing() {
    let calibration = Calibration::default();
    let five = |tick| (tick, if (500..600).contains(&tick) { 5 } else { 4 });
    let (report, data) = run_on(Box::new(Endless::new(true, five)), &calibration);
    assert_eq!(report.unwrap().summary.lost, 100);
    let data = data.unwrap();
    for channel in data.channels() {
        let loaded = data.load(&[channel.name.as_str()]).unwrap();
        let values = loaded.columns[0].values();
        assert!(values.iter().all(|value| *value == values[0]), "{channel:?}");
    }
}

#[test]
fn a_sample_with_an_earlier_tick_is_the_only_one_lost() {
    let calibration = Calibration::default();
    let back = |tick| (if tick == 700 { 600 } else { tick }, 4);
    let (report, data) = run_on(Box::new(Endless::new(true, back)), &calibration);
    let summary = report.unwrap().summary;
    assert_eq!((summary.missed, summary.refused), (1, 0));
    assert!(data.unwrap().rows() > 3000);
}

#[test]
fn a_run_that_does_not_start_leaves_an_older_recording() {
    let calibration = Calibration::default();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, "an older recording").unwrap();
    let board = Endless { runs: false, ..Endless::new(true, |tick| (tick, 4)) };
    let mut session = Session::open(Box::new(board), "test".into(), true).unwrap();
    let plan = Plan { replace: true, ..plan(&calibration, &path) };
    let problem = format!("{:#}", record(&mut session, plan, &Interrupt::default()).unwrap_err());
    assert!(problem.contains("does not start"), "{problem}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "an older recording");
    assert_eq!(folder.path().read_dir().unwrap().count(), 1);
}
