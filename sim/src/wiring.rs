//! The bench at a simulated board's connectors.

use socam_core::{ConverterSilent, GearmotorChannel, Ports};
use socam_recording::Calibration;

use crate::SimError;
use crate::bench::Bench;
use crate::plant::Effort;
use crate::setup::{Plants, Setup};

/// The bench at the board's connectors.
pub(crate) struct Wiring<'b> {
    bench: Bench<'b>,
    calibration: &'b Calibration,
    /// Simulated time since power-on.
    pub(crate) now_us: u64,
    command_v: f64,
    enabled: bool,
    failure: Option<SimError>,
}

impl<'b> Wiring<'b> {
    /// The bench at power-on, time 0.
    pub(crate) fn start(setup: &'b Setup, plants: &'b Plants) -> Result<Self, SimError> {
        Ok(Self {
            bench: Bench::start(setup, plants)?,
            calibration: &setup.calibration,
            now_us: 0,
            command_v: 0.0,
            enabled: false,
            failure: None,
        })
    }

    /// The error that ended the simulation, returned once.
    pub(crate) fn failed(&mut self) -> Result<(), SimError> {
        self.failure.take().map_or(Ok(()), Err)
    }

    pub(crate) fn effort(&self) -> Effort {
        self.bench.effort()
    }
}

impl Ports for Wiring<'_> {
    /// Either kind of board.
    type Count = i32;

    const WATCHES_MOTOR: bool = true;

    const TRANSDUCER: Option<u8> = Some(GearmotorChannel::SupplyCurrent as u8);

    fn now_us(&mut self) -> u64 {
        self.now_us
    }

    fn read(&mut self, counts: &mut [i32]) -> Result<(), ConverterSilent> {
        let read = self.bench.sample(self.now_us as f64 * 1e-6, counts);
        read.map_err(|error| {
            self.failure.get_or_insert(error);
            ConverterSilent
        })
    }

    fn write(&mut self, count: i16) -> Result<(), ConverterSilent> {
        self.command_v = self.calibration.output.volts(count);
        self.bench.command(self.command_v, self.enabled);
        Ok(())
    }

    fn inputs(&mut self) -> u8 {
        self.bench.inputs()
    }

    fn enable(&mut self, on: bool) {
        self.enabled = on;
        self.bench.command(self.command_v, on);
    }
}
