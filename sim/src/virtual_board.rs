//! A board in software: the core and link of the real one, on a simulated bench and clock.

use socam_core::scaling::Converter;
use socam_core::{Board, Ring, State};
use socam_wire::{
    BATCH_SAMPLES, BoardLink, EnableFeedback, FrontEnd, Identity, Image, MAX_FRAME, Start, Text,
};

use crate::SimError;
use crate::plant::Effort;
use crate::setup::Setup;
use crate::wiring::Wiring;

/// Samples between sampling and sending, as on the real board.
const RING_SAMPLES: usize = 1024;

/// Longest time that a frame waits for a full batch.
const LATEST_SEND_US: u64 = 20_000;

/// Interval of statuses.
const STATUS_EVERY_US: u64 = 200_000;

/// A board with its bench. It has no clock and no wire: [`advance`](Self::advance) advances its time, and bytes are passed in and
/// out.
pub struct VirtualBoard<'b> {
    board: Board<'b, Wiring<'b>, RING_SAMPLES>,
    link: BoardLink<'b, i32, RING_SAMPLES>,
    next_tick_us: u64,
    sent_us: u64,
    status_us: u64,
    told: State,
}

impl VirtualBoard<'_> {
    /// Builds the bench, switches the board on at time 0 and hands it to `serve`.
    ///
    /// # Errors
    /// [`SimError`] where the bench cannot be built.
    pub fn run<T>(setup: &Setup, serve: impl FnOnce(&mut VirtualBoard<'_>) -> T) -> Result<T, SimError> {
        let plants = setup.plants()?;
        let mut ring = Ring::<i32, RING_SAMPLES>::new();
        let (producer, consumer) = ring.split();
        let wiring = Wiring::start(setup, &plants)?;
        let identity = Identity {
            board: Text::new(&format!("virtual bench {}", setup.truth.model.name)),
            firmware: Text::new(concat!("socam-sim ", env!("CARGO_PKG_VERSION"))),
            front_end: FrontEnd {
                kind: setup.calibration.board,
                input_full_scale_uv: full_scale_uv(&setup.calibration.input),
                output_full_scale_uv: full_scale_uv(&setup.calibration.output),
                channel_step_ns: 0,
            },
            start: Start::Supply,
            enable_feedback: EnableFeedback::Nowhere,
            image: Image::Whole,
        };
        let mut board = VirtualBoard {
            board: Board::new(wiring, producer),
            link: BoardLink::new(identity, consumer),
            next_tick_us: 0,
            sent_us: 0,
            status_us: 0,
            told: State::Idle,
        };
        Ok(serve(&mut board))
    }

    /// The board's time.
    pub fn now_us(&mut self) -> u64 {
        self.board.ports_mut().now_us
    }

    /// State and counters of the board.
    pub fn state(&self) -> State {
        self.board.status().state
    }

    /// Takes bytes from the host and appends the answers to `out`. Says whether a message was among them.
    pub fn receive(&mut self, mut bytes: &[u8], out: &mut Vec<u8>) -> bool {
        let before = out.len();
        let mut frame = [0; MAX_FRAME];
        let Self { board, link, .. } = self;
        while let Some(len) = link.receive(&mut bytes, &mut frame, |request| board.handle(request)) {
            out.extend_from_slice(&frame[..len]);
        }
        out.len() > before
    }

    /// Advances the board's time to `until_us` and appends the bytes that it sends to `out`.
    ///
    /// # Errors
    /// [`SimError::Solver`] when the simulation of the bench failed.
    pub fn advance(&mut self, until_us: u64, out: &mut Vec<u8>) -> Result<(), SimError> {
        while self.next_tick_us <= until_us {
            self.board.ports_mut().now_us = self.next_tick_us;
            self.board.tick();
            self.next_tick_us += u64::from(self.board.config().sample_period_us);
            self.send(out);
        }
        let wiring = self.board.ports_mut();
        wiring.now_us = wiring.now_us.max(until_us);
        wiring.failed()
    }

    /// Effort of the simulation so far.
    pub fn effort(&mut self) -> Effort {
        self.board.ports_mut().effort()
    }

    /// Sends full batches at once, partial ones after their longest wait, and the status when it is due.
    fn send(&mut self, out: &mut Vec<u8>) {
        let mut frame = [0; MAX_FRAME];
        let now_us = self.now_us();
        let layout = self.board.layout();
        let status = self.board.status();
        let changed = status.state != self.told;
        let waited = now_us - self.sent_us >= LATEST_SEND_US;
        let at_least = if waited || changed { 1 } else { BATCH_SAMPLES };
        while let Some(len) = self.link.samples(layout, at_least, &mut frame) {
            out.extend_from_slice(&frame[..len]);
            self.sent_us = now_us;
        }
        if (changed || now_us - self.status_us >= STATUS_EVERY_US)
            && let Some(len) = self.link.status(status, &mut frame)
        {
            out.extend_from_slice(&frame[..len]);
            self.told = status.state;
            self.status_us = now_us;
        }
    }
}

/// Voltage at 2^15 counts, in microvolt, for any resolution of the converter.
fn full_scale_uv(converter: &Converter) -> u32 {
    (converter.volts_per_count() * 32_768e6).round() as u32
}
