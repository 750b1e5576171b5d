//! The settings of a simulated bench: drivetrain, drive, sensors and noise.

use socam_core::scaling::Converter;
use socam_core::{BoardKind, GearmotorChannel};
use socam_model::{Channel as ModelChannel, ChannelTransform, Model, Quantity, Role};
use socam_recording::{CalibratedChannel, Calibration, Channel, Unit, Winding};

use crate::channel::plain_channel;
use crate::drive::{self, Drive, driven_motor};
use crate::plant::Plant;
use crate::sensors::noise_std;
use crate::{SimError, Truth};

/// Name of the channel that replaces the board's tachometer on a bench without shafts.
pub const NO_TACHOMETER: &str = "no_tachometer";

/// The settings of a simulated bench.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The true drivetrain.
    pub truth: Truth,
    /// The drivetrain until a change in mid-run, and the time of the change after the drive was first enabled, s. `truth` continues from
    /// its states; if `None`, `truth` holds from the start.
    pub before: Option<(Truth, f64)>,
    /// The drive of the drivetrain.
    pub drive: Drive,
    /// Sensors and converters.
    pub calibration: Calibration,
    /// Seed of the sensors' noise.
    pub seed: u64,
    /// Whether sensors are noisy.
    pub noisy: bool,
    /// Standard deviations of the noise of single channels, by name, SI; the others have the default bench's. They count for
    /// noisy sensors only.
    pub noise_std: Vec<(String, f64)>,
    /// Lowest bits of each count that are always 0, for a converter of fewer bits than its counts have.
    pub empty_bits: u8,
}

/// Equations of a bench.
pub(crate) struct Plants {
    pub(crate) truth: Plant,
    /// Equations before a change in the middle of a run; `None` if nothing changes.
    pub(crate) before: Option<Plant>,
}

impl Setup {
    /// A bench with the default drive for the model, and with noise.
    pub fn new(truth: Truth, calibration: Calibration, seed: u64) -> Self {
        let drive = match calibration.board {
            BoardKind::Analog => Drive::for_model(&truth.model, &calibration.motor),
            BoardKind::Gearmotor => Drive::bridge(),
        };
        Self {
            truth,
            before: None,
            drive,
            calibration,
            seed,
            noisy: true,
            noise_std: Vec::new(),
            empty_bits: 0,
        }
    }

    /// Standard deviation of the noise of a channel's sensor, SI.
    pub(crate) fn noise_std_of(&self, channel: &CalibratedChannel) -> f64 {
        let is_computed = self.calibration.board == BoardKind::Gearmotor
            && self.calibration.channels.get(GearmotorChannel::MotorVoltage.index()) == Some(channel);
        // A transducer's noise is that of its own converter.
        if !self.noisy || is_computed || channel.is_transducer {
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

    /// Standard deviations of the noise of all channels, multiplied by a factor.
    pub(crate) fn noise_of_conversions(&self, factor: f64) -> Vec<(String, f64)> {
        let channels = self.calibration.channels.iter();
        channels.map(|channel| (channel.channel.name.clone(), factor * self.noise_std_of(channel))).collect()
    }

    /// Refuses noise of channels that do not exist, or a negative one.
    pub(crate) fn check_noise(&self) -> Result<(), SimError> {
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

    /// Equations of the drivetrain with its drive, now and before a change in the middle of a run. The outputs are those of the
    /// model, then the speeds of the shafts on whose angle a faulty sensor depends, a gearmotor's rotor, and the torque of a transducer.
    pub(crate) fn plants(&self) -> Result<Plants, SimError> {
        let truth = self.plant(&self.truth)?;
        let before = self.before.as_ref().map(|(before, _)| self.plant(before)).transpose()?;
        if let Some(before) = &before {
            truth.check_change(before)?;
        }
        Ok(Plants { truth, before })
    }

    fn plant(&self, truth: &Truth) -> Result<Plant, SimError> {
        let Truth { model, values, .. } = truth;
        if model.inputs().all(|channel| channel.quantity.is_clock()) {
            let problem = "it has no input that a profile could drive; `simulate --input RUN` lets it swing as in a recording";
            return Err(SimError::argument(&model.name, problem));
        }
        if let Some(channel) =
            model.inputs().next().filter(|channel| channel.transform != ChannelTransform::Value)
        {
            let problem = "it is made of another column (`take`), which the virtual bench cannot drive; give the model an input \
                           that is read as recorded first";
            return Err(SimError::argument(&channel.name, problem));
        }
        let watched = self.watched_model(model);
        let driven = drive::attach(&self.drive, model, &watched.equations(values)?);
        Plant::from_equations(&driven, values, model.motion)
    }

    /// The model with a tachometer on each of [`Self::watched_nodes`], and on a gearmotor's rotor.
    fn watched_model(&self, model: &Model) -> Model {
        let mut model = model.clone();
        let tachometers = self.watched_nodes().into_iter().map(|node| {
            let name = format!("shaft of {node}");
            plain_channel(Role::Output, Quantity::Speed, name, String::new(), node)
        });
        model.channels.extend(tachometers);
        let rotor = driven_motor(&model).filter(|_| self.calibration.board == BoardKind::Gearmotor);
        if let Some(motor) = rotor {
            let node = model.nodes[model.motors[motor].node].name.clone();
            let name = format!("rotor {node}");
            model.channels.push(plain_channel(Role::Output, Quantity::Speed, name, String::new(), node));
        }
        if let Some(shaft) = self.transducer_shaft(&model) {
            let name = format!("torque of {shaft}");
            model.channels.push(plain_channel(Role::Output, Quantity::Torque, name, String::new(), shaft));
        }
        model
    }

    /// The shaft in which a gearmotor's torque transducer sits: the elastic one that drives the node of the output's encoder. `None` where
    /// the calibration has no transducer or the model no such shaft.
    pub(crate) fn transducer_shaft(&self, model: &Model) -> Option<String> {
        let channels = &self.calibration.channels;
        channels.iter().find(|channel| channel.is_transducer)?;
        let angle = channels.get(GearmotorChannel::OutputAngle.index())?.channel.column_name();
        let encoder = model.outputs().find(|output| output.column == angle)?;
        let shaft = model
            .springs
            .iter()
            .find(|spring| spring.to.is_some_and(|to| model.nodes[to].name == encoder.at))?;
        Some(shaft.name.clone())
    }

    /// Name of the node on whose angle a sensor's fault depends, for each such fault.
    pub(crate) fn watched_nodes(&self) -> Vec<String> {
        let model = &self.truth.model;
        let following = self.truth.faults.iter().filter(|(_, fault)| fault.follows_shaft());
        let channels =
            following.filter_map(|(name, _)| model.channels.iter().find(|channel| channel.name == *name));
        channels.map(|channel| shaft_of(model, &channel.at)).collect()
    }
}

/// A calibration for a model's bench: the default one where it measures all the model's channels, that of a gearmotor board where the model is
/// driven by the column `motor_voltage_V` of that board, else one sensor per channel with a default range for its quantity.
pub fn calibration_for(model: &Model) -> Calibration {
    let usual = Calibration::default();
    let is_usual =
        |channel: &ModelChannel| usual.channels.iter().any(|c| c.channel.column_name() == channel.column);
    if model.channels.iter().all(is_usual) {
        return usual;
    }
    if let Some(calibration) = gearmotor_calibration(model) {
        return calibration;
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

/// The default calibration of a gearmotor board, with the model's winding.
fn gearmotor_calibration(model: &Model) -> Option<Calibration> {
    let mut calibration = Calibration::parse(Calibration::gearmotor_text()).ok()?;
    let motor = &model.motors[driven_motor(model)?];
    let column = calibration.channels.get(GearmotorChannel::MotorVoltage.index())?.channel.column_name();
    if model.inputs().next()?.column != column {
        return None;
    }
    let value = |parameter: usize| model.parameters[parameter].value;
    calibration.winding = calibration.winding.map(|winding| Winding {
        resistance_ohm: value(motor.resistance),
        back_emf_v_s: value(motor.back_emf),
        ..winding
    });
    Some(calibration)
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
        is_transducer: false,
        counts_per_turn: None,
        limit: None,
        stuck_s: None,
        missing_below: None,
        gain_std: None,
        offset_std: None,
    }
}

/// The node of a place: the node itself, or the driving end of a spring.
fn shaft_of(model: &Model, place: &str) -> String {
    let spring = model.springs.iter().find(|spring| spring.name == place);
    spring.map_or_else(|| place.to_owned(), |spring| model.nodes[spring.from].name.clone())
}
