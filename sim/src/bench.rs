//! The bench behind a board's connectors: drive, drivetrain and sensors.

use socam_core::scaling::Converter;
use socam_model::{Channel as ModelChannel, ChannelTransform, Model, Quantity, Role};
use socam_recording::{CalibratedChannel, Calibration, Channel, Unit};

use crate::drive::{self, Drive};
use crate::flaw::{Flaw, FlawedChannel};
use crate::plant::{Effort, Plant, Trajectory};
use crate::sensors::{Sensor, noise_std};
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
    /// Standard deviations of the noise of single channels, by name, SI; the others have the default bench's. They count for
    /// noisy sensors only.
    pub noise_std: Vec<(String, f64)>,
    /// A converter of fewer bits than its counts have leaves so many at zero.
    pub empty_bits: u8,
}

impl Setup {
    /// A bench with the drive that suits the model, and with noise.
    pub fn new(truth: Truth, calibration: Calibration, seed: u64) -> Self {
        let drive = Drive::for_model(&truth.model, &calibration.motor);
        Self { truth, drive, calibration, seed, noisy: true, noise_std: Vec::new(), empty_bits: 0 }
    }

    /// Standard deviation of the noise of a channel's sensor, SI.
    fn noise_std_of(&self, channel: &CalibratedChannel) -> f64 {
        if !self.noisy {
            return 0.0;
        }
        let own = self.noise_std.iter().find(|(name, _)| *name == channel.channel.name);
        own.map_or_else(|| noise_std(channel, &self.calibration.input), |(_, std)| *std)
    }

    /// Standard deviation of the noise of the sensor that measures a column, SI; `None` where nothing measures it.
    #[must_use]
    pub fn noise_std_of_column(&self, column: &str) -> Option<f64> {
        let channel =
            self.calibration.channels.iter().find(|channel| channel.channel.column_name() == column)?;
        Some(self.noise_std_of(channel))
    }

    /// The noise of all channels, so many times as large.
    pub(crate) fn noise_of_conversions(&self, factor: f64) -> Vec<(String, f64)> {
        let channels = self.calibration.channels.iter();
        channels.map(|channel| (channel.channel.name.clone(), factor * self.noise_std_of(channel))).collect()
    }

    /// Noise of channels that do not exist, or of an impossible size.
    fn check_noise(&self) -> Result<(), SimError> {
        for (name, std) in &self.noise_std {
            let channels = self.calibration.channels.iter().map(|channel| &channel.channel.name);
            if !channels.clone().any(|channel| channel == name) {
                let known: Vec<&str> = channels.map(String::as_str).collect();
                let problem =
                    format!("there is no such channel to be noisy; the bench has {}", known.join(", "));
                return Err(SimError::argument(name, problem));
            }
            if !(std.is_finite() && *std >= 0.0) {
                return Err(SimError::argument(
                    name,
                    format!("its noise is {std}, but it must be 0 or more"),
                ));
            }
        }
        Ok(())
    }

    /// Equations of the drivetrain with its drive. Behind the model's outputs come the speeds of shafts whose angle a flawed
    /// sensor depends on.
    pub(crate) fn plant(&self) -> Result<Plant, SimError> {
        let Truth { model, values, .. } = &self.truth;
        if let Some(channel) =
            model.inputs().next().filter(|channel| channel.transform != ChannelTransform::Value)
        {
            let problem = "it is made of another column (`take`), which the virtual bench cannot drive; give the model an input \
                           that is read as recorded first";
            return Err(SimError::argument(&channel.name, problem));
        }
        let watched = self.watched_model();
        let driven = drive::attach(&self.drive, model, &watched.equations(values)?);
        Plant::from_equations(&driven, values, model.motion)
    }

    /// The model with a tachometer on each of [`Self::watched_nodes`].
    fn watched_model(&self) -> Model {
        let mut model = self.truth.model.clone();
        let tachometers = self.watched_nodes().into_iter().map(|node| ModelChannel {
            name: format!("shaft of {node}"),
            column: String::new(),
            role: Role::Output,
            quantity: Quantity::Speed,
            at: node,
            take: ChannelTransform::Value,
            scale: 1.0,
            offset: 0.0,
            noise_std: None,
            gain: None,
            estimate_offset: false,
            between: None,
            unit: "",
        });
        model.channels.extend(tachometers);
        model
    }

    /// Nodes whose angle a sensor's ripple follows, flaw by flaw.
    fn watched_nodes(&self) -> Vec<String> {
        let model = &self.truth.model;
        let ripples = self.truth.flaws.iter().filter(|(_, flaw)| matches!(flaw, Flaw::Ripple { .. }));
        let channels =
            ripples.filter_map(|(name, _)| model.channels.iter().find(|channel| channel.name == *name));
        channels.map(|channel| shaft_of(model, &channel.at)).collect()
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
    let volts_per_unit = Converter::DEFAULT.full_scale_v / full_scale;
    CalibratedChannel {
        channel,
        sensor: socam_core::scaling::Sensor { volts_per_unit, offset_v: 0.0 },
        limit: None,
        stuck_s: None,
        missing_below: None,
        gain_std: None,
        offset_std: None,
    }
}

/// The node whose angle a place turns with: itself, or the driving end of a spring.
fn shaft_of(model: &Model, place: &str) -> String {
    let spring = model.springs.iter().find(|spring| spring.name == place);
    spring.map_or_else(|| place.to_owned(), |spring| model.nodes[spring.from].name.clone())
}

/// Conversions between two samples. A sample is the mean of those in the last two sampling intervals, those in the middle
/// counting most: so a converter that is faster than the sampling keeps what lies about the sampling frequency (the steps
/// of the command) from passing for something slow. It does so on all channels alike, which changes nothing between them.
const CONVERSIONS: u32 = 4;

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
    converter: Converter,
    empty_bits: u8,
    inputs: Vec<Input>,
    outputs: Vec<f64>,
    /// Outputs that are speeds of watched shafts, and the shafts' angles, rad.
    shafts: Vec<(usize, f64)>,
    settles_at: f64,
    /// When sensors were read last.
    read_at_s: f64,
    /// What the conversions since the last sample add to the next one.
    rising: Vec<f64>,
}

/// One input of the board: what is measured, how it is falsified, how it is read.
struct Input {
    source: Source,
    /// Each with the shaft that it follows, if it does.
    flaws: Vec<(FlawedChannel, Option<usize>)>,
    sensor: Sensor,
}

impl<'p> Bench<'p> {
    pub(crate) fn start(setup: &Setup, plant: &'p Plant) -> Result<Self, SimError> {
        setup.check_noise()?;
        let model = &setup.truth.model;
        let calibration = &setup.calibration;
        let first_shaft = 1 + model.outputs().count();
        let shafts = 0..setup.watched_nodes().len();
        let outputs = first_shaft + shafts.len();
        let inputs = calibration.channels.iter().zip(0u64..).map(|(channel, stream)| Input {
            source: source(setup, &channel.channel),
            flaws: flaws(setup, &channel.channel),
            sensor: Sensor::new(channel, setup.seed, stream, setup.noise_std_of(channel)),
        });
        Ok(Self {
            trajectory: plant.start()?,
            drive: setup.drive.clone(),
            converter: Converter {
                bits: calibration.input.bits.saturating_sub(setup.empty_bits),
                ..calibration.input
            },
            empty_bits: setup.empty_bits,
            inputs: inputs.collect(),
            outputs: vec![0.0; outputs],
            shafts: shafts.map(|shaft| (first_shaft + shaft, 0.0)).collect(),
            settles_at: 0.0,
            read_at_s: 0.0,
            rising: vec![0.0; outputs],
        })
    }

    /// From now on the drive has this voltage; a disabled drive brakes to standstill.
    pub(crate) fn command(&mut self, volts: f64, enabled: bool) {
        self.settles_at = if enabled { self.drive.settles_at(volts) } else { 0.0 };
    }

    /// Lets time pass up to `to_s`, and reads all sensors: each a mean, see [`CONVERSIONS`]. Channels without a
    /// sensor read 0.
    pub(crate) fn sample(&mut self, to_s: f64, counts: &mut [i16]) -> Result<(), SimError> {
        let from_s = self.trajectory.time_s();
        let step_s = to_s - from_s;
        let blank = vec![0.0; self.outputs.len()];
        let mut rising = std::mem::replace(&mut self.rising, blank);
        let mut falling = vec![0.0; self.outputs.len()];
        for conversion in 1..=CONVERSIONS {
            let share = f64::from(conversion) / f64::from(CONVERSIONS);
            let at_s = if conversion == CONVERSIONS { to_s } else { from_s + step_s * share };
            self.trajectory.hold(at_s, &[self.settles_at, 1.0])?;
            self.trajectory.outputs(&mut self.outputs);
            for (row, value) in self.outputs.iter().enumerate() {
                falling[row] += value * (1.0 - share) / f64::from(CONVERSIONS);
                self.rising[row] += value * share / f64::from(CONVERSIONS);
            }
        }
        rising.iter_mut().zip(falling).for_each(|(mean, late)| *mean += late);
        self.outputs.copy_from_slice(&rising);
        self.shafts.iter_mut().for_each(|(row, angle_rad)| *angle_rad += rising[*row] * step_s);
        counts.fill(0);
        let (converter, empty_bits) = (self.converter, self.empty_bits);
        // The mean is of a sample's length around the last instant: what hums hums then.
        for (count, volts) in counts.iter_mut().zip(self.read(from_s, step_s)) {
            *count = converter.count(volts) << empty_bits;
        }
        Ok(())
    }

    /// Lets time pass up to `to_s`, and reads all sensors as they are at that instant, in volt.
    pub(crate) fn voltages(&mut self, to_s: f64, volts: &mut [f64]) -> Result<(), SimError> {
        // Not since the trajectory's own time: commands come between readings.
        let step_s = to_s - self.read_at_s;
        self.read_at_s = to_s;
        self.pass(to_s)?;
        self.trajectory.outputs(&mut self.outputs);
        let outputs = &self.outputs;
        self.shafts.iter_mut().for_each(|(row, angle_rad)| *angle_rad += outputs[*row] * step_s);
        volts.iter_mut().zip(self.read(to_s, step_s)).for_each(|(volts, now)| *volts = now);
        Ok(())
    }

    /// Lets time pass.
    pub(crate) fn pass(&mut self, to_s: f64) -> Result<(), SimError> {
        self.trajectory.hold(to_s, &[self.settles_at, 1.0])
    }

    /// What the sensors make of the outputs, in volt.
    fn read(&mut self, at_s: f64, step_s: f64) -> impl Iterator<Item = f64> {
        let (outputs, shafts) = (&self.outputs, &self.shafts);
        self.inputs.iter_mut().map(move |input| {
            let mut value = match input.source {
                Source::Output { row, scale, offset } => (outputs[row] - offset) / scale,
                Source::Current { row, torque_per_current } => outputs[row] / torque_per_current,
                Source::Nothing => 0.0,
            };
            for (flaw, shaft) in &mut input.flaws {
                let angle_rad = shaft.map_or(0.0, |shaft| shafts[shaft].1);
                value = flaw.pass(value, at_s, step_s, angle_rad);
            }
            input.sensor.volts(value)
        })
    }

    pub(crate) fn effort(&self) -> Effort {
        self.trajectory.effort()
    }
}

/// The flaws of a board's input. Shafts are numbered in the order of [`Setup::watched_nodes`].
fn flaws(setup: &Setup, channel: &Channel) -> Vec<(FlawedChannel, Option<usize>)> {
    let model = &setup.truth.model;
    let column = channel.column_name();
    let mut shafts = 0..;
    let numbered = setup.truth.flaws.iter().map(|(name, flaw)| {
        let follows = matches!(flaw, Flaw::Ripple { .. });
        (name, flaw, if follows { shafts.next() } else { None })
    });
    let is_here =
        |name: &str| model.channels.iter().any(|channel| channel.name == name && channel.column == column);
    numbered
        .filter(|(name, ..)| is_here(name))
        .map(|(_, flaw, shaft)| (FlawedChannel::new(*flaw), shaft))
        .collect()
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
