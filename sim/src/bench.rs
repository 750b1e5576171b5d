//! The bench behind a board's connectors: drive, drivetrain and sensors.

use socam_core::scaling::Converter;
use socam_core::{BoardKind, GearmotorChannel};
use socam_recording::Channel;

use crate::SimError;
use crate::drive::{self, Drive};
use crate::fault::{FaultyChannel, Instant};
use crate::gearmotor::{Gearmotor, GearmotorPins, SupplyRows, VOLTAGE_ROW};
use crate::plant::{Effort, Plant, Trajectory};
use crate::sensors::Sensor;
use crate::setup::{Plants, Setup};
use crate::transducer::Transducer;

/// Name of the channel that is computed from the motor's torque.
const MOTOR_CURRENT: &str = "motor_current";

/// Conversions per sample. A sample is their triangular mean over the last two sampling intervals, which suppresses what would alias
/// from around the sampling frequency (the steps of the command). All channels have the same filter, so ratios between them are
/// unchanged.
const CONVERSIONS: u32 = 4;

/// Quantity that a sensor measures.
#[derive(Debug, Clone, Copy)]
enum Source {
    /// column = (output - offset) / scale.
    Output { row: usize, scale: f64, offset: f64 },
    /// The motor's current, computed from the torque on its shaft.
    Current { row: usize, torque_per_current: f64 },
    /// No quantity: the sensor has only its offset and noise.
    Nothing,
}

/// A change of the drivetrain in mid-run.
struct Change<'p> {
    plant: &'p Plant,
    /// Time after the drive was first enabled, s.
    after_s: f64,
    /// Time at which the drive was first enabled, s.
    enabled_s: Option<f64>,
}

impl Change<'_> {
    fn is_due(&self, at_s: f64) -> bool {
        self.enabled_s.is_some_and(|enabled_s| at_s >= enabled_s + self.after_s)
    }
}

/// A running bench.
pub(crate) struct Bench<'p> {
    trajectory: Trajectory<'p>,
    /// `None` once it has happened.
    change: Option<Change<'p>>,
    drive: Drive,
    converter: Converter,
    empty_bits: u8,
    inputs: Vec<Input>,
    /// Encoders and supply, where the board is a gearmotor's.
    gearmotor: Option<Gearmotor>,
    /// The torque transducer with the number of its channel, if the board has one.
    transducer: Option<(usize, Transducer)>,
    /// Rows of the plant, then those of the supply.
    outputs: Vec<f64>,
    supply: SupplyRows,
    /// Output row of the speed of each shaft on which a fault depends, and the shaft's angle, rad.
    shafts: Vec<(usize, f64)>,
    settles_at: f64,
    /// Time of the last reading, s.
    read_at_s: f64,
    /// The rising half of the next sample's triangular mean.
    rising: Vec<f64>,
}

/// One input of the board: measured quantity, faults, sensor.
struct Input {
    source: Source,
    /// Each fault with the index of the shaft on which it depends.
    faults: Vec<(FaultyChannel, Option<usize>)>,
    sensor: Sensor,
}

impl<'p> Bench<'p> {
    pub(crate) fn start(setup: &Setup, plants: &'p Plants) -> Result<Self, SimError> {
        setup.check_noise()?;
        let model = &setup.truth.model;
        let calibration = &setup.calibration;
        let first_shaft = 1 + model.outputs().count();
        let shafts = 0..setup.watched_nodes().len();
        let is_gearmotor = calibration.board == BoardKind::Gearmotor;
        // The rotor's speed is the last row of a gearmotor's plant.
        let rotor = first_shaft + shafts.len();
        let transducer = calibration.channels.iter().position(|channel| channel.is_transducer);
        let torque = setup.transducer_shaft(model).map(|_| rotor + 1);
        let supply = SupplyRows::after(rotor + usize::from(is_gearmotor) + usize::from(torque.is_some()));
        let outputs = supply.voltage + if is_gearmotor { 2 } else { 0 };
        let gearmotor = is_gearmotor.then(|| Gearmotor::start(setup, rotor)).transpose()?;
        let inputs =
            calibration.channels.iter().zip(0u64..).enumerate().map(|(place, (channel, stream))| Input {
                source: match torque.filter(|_| transducer == Some(place)) {
                    Some(row) => Source::Output { row, scale: 1.0, offset: 0.0 },
                    None => {
                        if is_gearmotor && transducer != Some(place) { electric(place, supply) } else { None }
                            .unwrap_or_else(|| source(setup, &channel.channel))
                    }
                },
                faults: faults(setup, &channel.channel),
                sensor: Sensor::new(channel, setup.seed, stream, setup.noise_std_of(channel)),
            });
        Ok(Self {
            trajectory: plants.before.as_ref().unwrap_or(&plants.truth).start()?,
            change: setup.before.as_ref().map(|(_, after_s)| Change {
                plant: &plants.truth,
                after_s: *after_s,
                enabled_s: None,
            }),
            drive: setup.drive.clone(),
            converter: Converter {
                bits: calibration.input.bits.saturating_sub(setup.empty_bits),
                ..calibration.input
            },
            empty_bits: setup.empty_bits,
            inputs: inputs.collect(),
            gearmotor,
            transducer: transducer.map(|place| (place, Transducer::new(setup.seed, setup.noisy))),
            supply,
            outputs: vec![0.0; outputs],
            shafts: shafts.map(|shaft| (first_shaft + shaft, 0.0)).collect(),
            settles_at: 0.0,
            read_at_s: 0.0,
            rising: vec![0.0; outputs],
        })
    }

    /// Sets the drive's voltage; a disabled drive brakes to standstill, a disabled bridge lets its motor coast.
    pub(crate) fn command(&mut self, volts: f64, enabled: bool) {
        if let Some(change) = self.change.as_mut().filter(|_| enabled) {
            change.enabled_s.get_or_insert(self.trajectory.time_s());
        }
        self.settles_at = match &mut self.gearmotor {
            Some(gearmotor) => gearmotor.command(volts, enabled, &self.outputs),
            None if enabled => self.drive.settles_at(volts),
            None => 0.0,
        };
    }

    /// Simulates to `to_s` and samples all sensors, each as a mean, see [`CONVERSIONS`]. Channels without a sensor read 0.
    pub(crate) fn sample(&mut self, to_s: f64, counts: &mut [i32]) -> Result<(), SimError> {
        self.change_if_due()?;
        let from_s = self.trajectory.time_s();
        let step_s = to_s - from_s;
        let blank = vec![0.0; self.outputs.len()];
        let mut rising = std::mem::replace(&mut self.rising, blank);
        let mut falling = vec![0.0; self.outputs.len()];
        for conversion in 1..=CONVERSIONS {
            let share = f64::from(conversion) / f64::from(CONVERSIONS);
            let at_s = if conversion == CONVERSIONS { to_s } else { from_s + step_s * share };
            self.trajectory.hold(at_s, &[self.settles_at, 1.0])?;
            self.trajectory.outputs(&mut self.outputs[..self.supply.voltage]);
            if let Some(gearmotor) = &mut self.gearmotor {
                gearmotor.convert(at_s, &mut self.outputs, self.supply);
                self.settles_at = gearmotor.applied(&self.outputs);
            }
            for (row, value) in self.outputs.iter().enumerate() {
                // A mean since the conversion before belongs to the middle of that time.
                let is_mean = row == VOLTAGE_ROW && self.gearmotor.is_some();
                let share = if is_mean { share - 0.5 / f64::from(CONVERSIONS) } else { share };
                falling[row] += value * (1.0 - share) / f64::from(CONVERSIONS);
                self.rising[row] += value * share / f64::from(CONVERSIONS);
            }
        }
        rising.iter_mut().zip(falling).for_each(|(mean, late)| *mean += late);
        self.outputs.copy_from_slice(&rising);
        self.shafts.iter_mut().for_each(|(row, angle_rad)| *angle_rad += rising[*row] * step_s);
        counts.fill(0);
        let (converter, empty_bits) = (self.converter, self.empty_bits);
        // The mean is centred on the previous sample: hum is evaluated there.
        let of_transducer = self.transducer.as_ref().map(|(place, _)| *place);
        let mut codes = None;
        for (place, (count, volts)) in counts.iter_mut().zip(self.read(from_s, step_s)).enumerate() {
            *count = i32::from(converter.count(volts) << empty_bits);
            codes = codes.or((of_transducer == Some(place)).then_some(volts));
        }
        if let Some(((place, transducer), codes)) = self.transducer.as_mut().zip(codes) {
            counts[*place] = transducer.step(to_s, codes);
        }
        if let Some(gearmotor) = &self.gearmotor {
            gearmotor.read(counts);
        }
        Ok(())
    }

    /// Simulates to `to_s` and reads all sensors at that instant, in volt.
    pub(crate) fn voltages(&mut self, to_s: f64, volts: &mut [f64]) -> Result<(), SimError> {
        // Commands between readings have advanced the trajectory, so its time is not that of the last reading.
        let step_s = to_s - self.read_at_s;
        self.read_at_s = to_s;
        self.pass(to_s)?;
        self.trajectory.outputs(&mut self.outputs[..self.supply.voltage]);
        let outputs = &self.outputs;
        self.shafts.iter_mut().for_each(|(row, angle_rad)| *angle_rad += outputs[*row] * step_s);
        volts.iter_mut().zip(self.read(to_s, step_s)).for_each(|(volts, now)| *volts = now);
        Ok(())
    }

    /// Simulates to `to_s` with a gearmotor's bridge at a duty, or off; `None` where the bench is no gearmotor.
    pub(crate) fn bridge(&mut self, to_s: f64, duty: Option<f64>) -> Result<Option<GearmotorPins>, SimError> {
        let Some(gearmotor) = &mut self.gearmotor else { return Ok(None) };
        self.settles_at = gearmotor.bridge(duty, &self.outputs);
        let from_s = self.trajectory.time_s();
        self.pass(to_s)?;
        self.trajectory.outputs(&mut self.outputs[..self.supply.voltage]);
        let Some(gearmotor) = &mut self.gearmotor else { return Ok(None) };
        gearmotor.load_supply(&mut self.outputs, self.supply);
        let angles_rad = gearmotor.angles_rad(&self.outputs);
        let read: Vec<f64> = self.read(to_s, to_s - from_s).collect();
        let volts = [
            GearmotorChannel::MotorCurrent,
            GearmotorChannel::SupplyCurrent,
            GearmotorChannel::SupplyVoltage,
        ]
        .map(|channel| read.get(channel.index()).copied().unwrap_or(0.0));
        Ok(Some(GearmotorPins { angles_rad, volts }))
    }

    /// Simulates to `to_s`.
    pub(crate) fn pass(&mut self, to_s: f64) -> Result<(), SimError> {
        self.change_if_due()?;
        self.trajectory.hold(to_s, &[self.settles_at, 1.0])
    }

    /// Changes the drivetrain when its time has come.
    fn change_if_due(&mut self) -> Result<(), SimError> {
        let at_s = self.trajectory.time_s();
        if let Some(change) = self.change.take_if(|change| change.is_due(at_s)) {
            self.trajectory = change.plant.start_after(&self.trajectory)?;
        }
        Ok(())
    }

    /// The sensors' voltages at the present outputs, V.
    fn read(&mut self, at_s: f64, step_s: f64) -> impl Iterator<Item = f64> {
        let (outputs, shafts, is_faulty) = (&self.outputs, &self.shafts, self.change.is_none());
        self.inputs.iter_mut().map(move |input| {
            let mut value = match input.source {
                Source::Output { row, scale, offset } => (outputs[row] - offset) / scale,
                Source::Current { row, torque_per_current } => outputs[row] / torque_per_current,
                Source::Nothing => 0.0,
            };
            for (fault, shaft) in input.faults.iter_mut().filter(|_| is_faulty) {
                let angle_rad = shaft.map_or(0.0, |shaft| shafts[shaft].1);
                value = fault.read(value, Instant { time_s: at_s, step_s, angle_rad });
            }
            input.sensor.volts(value)
        })
    }

    /// The digital inputs since the last call.
    pub(crate) fn inputs(&mut self) -> u8 {
        self.gearmotor.as_mut().map_or(0, Gearmotor::inputs)
    }

    pub(crate) fn effort(&self) -> Effort {
        self.trajectory.effort()
    }
}

/// The faults of a board's input. Shafts are numbered in the order of [`Setup::watched_nodes`].
fn faults(setup: &Setup, channel: &Channel) -> Vec<(FaultyChannel, Option<usize>)> {
    let model = &setup.truth.model;
    let column = channel.column_name();
    let mut shafts = 0..;
    let numbered = setup
        .truth
        .faults
        .iter()
        .map(|(name, fault)| (name, fault, if fault.follows_shaft() { shafts.next() } else { None }));
    let is_here =
        |name: &str| model.channels.iter().any(|channel| channel.name == name && channel.column == column);
    numbered
        .filter(|(name, ..)| is_here(name))
        .map(|(_, fault, shaft)| (FaultyChannel::new(fault.clone()), shaft))
        .collect()
}

/// What a gearmotor board measures of bridge and supply, at its place among the channels.
fn electric(place: usize, supply: SupplyRows) -> Option<Source> {
    let at = |row| Some(Source::Output { row, scale: 1.0, offset: 0.0 });
    match place {
        place if place == GearmotorChannel::SupplyCurrent.index() => at(supply.current),
        place if place == GearmotorChannel::SupplyVoltage.index() => at(supply.voltage),
        place if place == GearmotorChannel::MotorVoltage.index() => at(0),
        _ => None,
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
