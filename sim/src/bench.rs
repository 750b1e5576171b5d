//! The bench behind a board's connectors: drive, drivetrain and sensors.

use socam_model::{Channel as ModelChannel, Model};
use socam_recording::{CalibratedChannel, Calibration, Channel, Unit};

use crate::drive::{self, Drive};
use crate::plant::{Effort, Plant, Trajectory};
use crate::sensors::Sensor;
use crate::{SimError, Truth};

/// A channel that stands in for the tachometer that a board wants and a bench without shafts does not have.
pub const NO_TACHOMETER: &str = "no_tachometer";

/// A channel that is worked out from the motor's torque where a calibration names it.
const MOTOR_CURRENT: &str = "motor_current";

/// Everything that makes a simulated bench.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The drivetrain as it really is.
    pub truth: Truth,
    /// The drive in front of it.
    pub drive: Drive,
    /// Sensors and converters.
    pub calibration: Calibration,
    /// Draws the sensors' noise.
    pub seed: u64,
    /// Whether sensors are noisy.
    pub noisy: bool,
}

impl Setup {
    /// A bench with the drive that suits the model, and with noise.
    pub fn new(truth: Truth, calibration: Calibration, seed: u64) -> Self {
        let drive = Drive::for_model(&truth.model, &calibration.motor);
        Self { truth, drive, calibration, seed, noisy: true }
    }

    pub(crate) fn plant(&self) -> Result<Plant, SimError> {
        let Truth { model, values } = &self.truth;
        let driven = drive::attach(&self.drive, model, &self.truth.equations()?);
        Plant::from_equations(&driven, values, model.motion)
    }
}

/// A calibration for a model's bench: the default one where it measures all the model's channels, else one sensor per
/// channel with a range that suits its quantity.
pub fn calibration_for(model: &Model) -> Calibration {
    let usual = Calibration::default();
    let is_usual =
        |channel: &ModelChannel| usual.channels.iter().any(|c| c.channel.column_name() == channel.column);
    if model.channels.iter().all(is_usual) {
        return usual;
    }
    let mut channels: Vec<_> = model.inputs().chain(model.outputs()).filter_map(plain_sensor).collect();
    let tachometer = channels.iter().find(|channel| channel.channel.unit == Unit::RadPerS);
    let tachometer = tachometer.map(|channel| channel.channel.name.clone());
    if tachometer.is_none() {
        channels.push(sensor(Channel::new(NO_TACHOMETER, Unit::RadPerS), 1.0));
    }
    let mut calibration = Calibration { channels, ..usual };
    calibration.speed_control.tachometer = tachometer.unwrap_or_else(|| NO_TACHOMETER.into());
    calibration
}

fn plain_sensor(channel: &ModelChannel) -> Option<CalibratedChannel> {
    let channel = Channel::from_column_name(&channel.column)?;
    let full_scale = match channel.unit {
        Unit::RadPerS => 200.0,
        Unit::Nm => 20.0,
        Unit::Rad => 50.0,
        Unit::MPerS => 2.0,
        Unit::M => 0.5,
        Unit::N => 1000.0,
        _ => 100.0,
    };
    Some(sensor(channel, full_scale))
}

fn sensor(channel: Channel, full_scale: f64) -> CalibratedChannel {
    let volts_per_unit = 10.0 / full_scale;
    CalibratedChannel {
        channel,
        sensor: socam_core::scaling::Sensor { volts_per_unit, offset_v: 0.0 },
        limit: None,
        stuck_s: None,
        missing_below: None,
    }
}

/// What a sensor is attached to.
#[derive(Debug, Clone, Copy)]
enum Source {
    /// column = (output - offset) / scale.
    Output { row: usize, scale: f64, offset: f64 },
    /// Motor's current, from the torque on its shaft.
    Current { row: usize, torque_per_current: f64 },
    /// Nothing: reads its offset and noise.
    Nothing,
}

/// A bench in motion.
pub(crate) struct Bench<'p> {
    trajectory: Trajectory<'p>,
    drive: Drive,
    sensors: Vec<(Sensor, Source)>,
    outputs: Vec<f64>,
    settles_at: f64,
}

impl<'p> Bench<'p> {
    pub(crate) fn start(setup: &Setup, plant: &'p Plant) -> Result<Self, SimError> {
        let model = &setup.truth.model;
        let calibration = &setup.calibration;
        let sensors = calibration.channels.iter().zip(0u64..).map(|(channel, stream)| {
            let sensor = Sensor::new(channel, calibration.input, setup.seed, stream, setup.noisy);
            (sensor, source(setup, &channel.channel))
        });
        Ok(Self {
            trajectory: plant.start()?,
            drive: setup.drive.clone(),
            sensors: sensors.collect(),
            outputs: vec![0.0; 1 + model.outputs().count()],
            settles_at: 0.0,
        })
    }

    /// From now on the drive has this voltage; a disabled drive brakes to standstill.
    pub(crate) fn command(&mut self, volts: f64, enabled: bool) {
        self.settles_at = if enabled { self.drive.settles_at(volts) } else { 0.0 };
    }

    /// Lets time pass up to `to_s`, and reads all sensors at that instant. Channels without a sensor read 0.
    pub(crate) fn sample(&mut self, to_s: f64, counts: &mut [i16]) -> Result<(), SimError> {
        self.trajectory.hold(to_s, &[self.settles_at])?;
        self.trajectory.outputs(&mut self.outputs);
        counts.fill(0);
        for (count, (sensor, source)) in counts.iter_mut().zip(&mut self.sensors) {
            let value = match *source {
                Source::Output { row, scale, offset } => (self.outputs[row] - offset) / scale,
                Source::Current { row, torque_per_current } => self.outputs[row] / torque_per_current,
                Source::Nothing => 0.0,
            };
            *count = sensor.count(value);
        }
        Ok(())
    }

    pub(crate) fn effort(&self) -> Effort {
        self.trajectory.effort()
    }
}

fn source(setup: &Setup, channel: &Channel) -> Source {
    let model = &setup.truth.model;
    let column = channel.column_name();
    // The driven quantity is output 0, see `drive::attach`.
    let mut measured = model.inputs().take(1).chain(model.outputs());
    if let Some(row) = measured.position(|candidate| candidate.column == column) {
        let (scale, offset) = model
            .inputs()
            .take(1)
            .chain(model.outputs())
            .nth(row)
            .map_or((1.0, 0.0), |channel| (channel.scale, channel.offset));
        return Source::Output { row, scale, offset };
    }
    match drive::reaction_output(model) {
        Some(row) if channel.name == MOTOR_CURRENT => {
            Source::Current { row: row + 1, torque_per_current: setup.drive.torque_per_current }
        }
        _ => Source::Nothing,
    }
}
