//! What a gearmotor board sees of a bench: encoders with their edges, and a supply behind an H-bridge.

use std::f64::consts::TAU;

use socam_core::encoder::{Encoder, EncoderReading};
use socam_core::{GearmotorChannel, bridge};
use socam_model::Model;
use socam_recording::Calibration;

use crate::SimError;
use crate::drive::driven_motor;
use crate::setup::Setup;

/// Two to this power is the number of readings per sample.
const LOG2_CONVERSIONS: u32 = 2;

/// The encoders' clock: the time of an edge is known to a tenth of a microsecond.
const TICKS_PER_S: u32 = 10_000_000;

/// Largest displacement of an edge of an encoder, in counts: its tracks are not evenly spaced.
const UNEVENNESS: f64 = 0.08;

/// A power supply of 12 V, and its resistance with cables.
const SUPPLY_V: f64 = 12.0;
const SUPPLY_OHM: f64 = 0.1;

/// Output row of the voltage at the motor.
pub(crate) const VOLTAGE_ROW: usize = 0;

/// Encoders and supply of a running bench.
pub(crate) struct Gearmotor {
    encoders: [Option<VirtualEncoder>; 2],
    /// Row of the motor's current.
    current_row: Option<usize>,
    /// Row of the rotor's speed, and V s/rad: what a motor that nothing drives shows at its terminals.
    coasts: (usize, f64),
    supply_v: f64,
    /// Time constants of the bridge together, s.
    bridge_lag_s: f64,
    /// Time of the last conversion, s, and the voltage that the bridge had reached then.
    converted: (f64, f64),
    /// Duty of the bridge, -1 to 1; `None` while it is off.
    duty: Option<f64>,
    /// Whether the first encoder's index was passed since it was asked for.
    is_index: bool,
}

/// What a gearmotor board's pins see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GearmotorPins {
    /// Angles of the motor's and of the output's encoder, rad.
    pub angles_rad: [f64; 2],
    /// Voltages of the motor's current, of the supply's current and of the supply at the converter, V. Where a torque transducer is in place
    /// of the supply's current, the second one is what its converter is at, in codes.
    pub volts: [f64; 3],
}

/// The rows that a gearmotor adds to the outputs of the plant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SupplyRows {
    pub(crate) voltage: usize,
    pub(crate) current: usize,
}

impl SupplyRows {
    /// The rows behind those of the plant.
    pub(crate) fn after(plant: usize) -> Self {
        Self { voltage: plant, current: plant + 1 }
    }
}

impl Gearmotor {
    /// A bench at rest, with its supply on. `rotor_row` is the output row of the rotor's speed.
    pub(crate) fn start(setup: &Setup, rotor_row: usize) -> Result<Self, SimError> {
        let Setup { truth, calibration, drive, .. } = setup;
        let model = &truth.model;
        let problem = "a gearmotor board drives a winding: the model's first input must be the voltage of one of its [[motors]]";
        let motor = driven_motor(model).ok_or_else(|| SimError::argument(&model.name, problem))?;
        let back_emf = truth.values[model.motors[motor].back_emf];
        let row = |channel: GearmotorChannel| row_of(model, calibration, channel);
        let unevenness = if setup.noisy { UNEVENNESS } else { 0.0 };
        let encoder = |channel: GearmotorChannel| {
            let per_turn = calibration.channels.get(channel.index())?.counts_per_turn?;
            Some(VirtualEncoder::new(row(channel)?, per_turn, unevenness))
        };
        Ok(Self {
            encoders: [encoder(GearmotorChannel::MotorAngle), encoder(GearmotorChannel::OutputAngle)],
            current_row: row(GearmotorChannel::MotorCurrent),
            coasts: (rotor_row, back_emf),
            supply_v: SUPPLY_V,
            bridge_lag_s: drive.lag_s + drive.armature_lag_s,
            converted: (0.0, 0.0),
            duty: None,
            is_index: false,
        })
    }

    /// The voltage at the motor for a command, until the next conversion.
    pub(crate) fn command(&mut self, wanted_v: f64, enabled: bool, outputs: &[f64]) -> f64 {
        let micro = |volts: f64| (volts * 1e6).round() as i32;
        let duty = bridge::duty(micro(wanted_v), micro(self.supply_v));
        self.duty = enabled.then(|| f64::from(duty) / f64::from(bridge::FULL_DUTY));
        self.applied(outputs)
    }

    /// Sets the bridge's duty, -1 to 1, or switches it off; returns the voltage at the motor.
    pub(crate) fn bridge(&mut self, duty: Option<f64>, outputs: &[f64]) -> f64 {
        self.duty = duty;
        self.applied(outputs)
    }

    /// The voltage at the motor: a bridge that is off leaves it its own, so that no current flows.
    pub(crate) fn applied(&self, outputs: &[f64]) -> f64 {
        let (row, back_emf) = self.coasts;
        self.duty.map_or(back_emf * outputs[row], |duty| duty * self.supply_v)
    }

    /// Takes a conversion: the plant's outputs are given, those of the supply are added. The voltage becomes its mean since the conversion
    /// before: it steps at conversions, and the board knows from its bridge's duty what was applied between two of them.
    pub(crate) fn convert(&mut self, at_s: f64, outputs: &mut [f64], rows: SupplyRows) {
        let (before_s, before_v) = std::mem::replace(&mut self.converted, (at_s, outputs[VOLTAGE_ROW]));
        let late = (self.bridge_lag_s / (at_s - before_s)).min(1.0);
        outputs[VOLTAGE_ROW] += (before_v - outputs[VOLTAGE_ROW]) * late;
        self.load_supply(outputs, rows);
        let [motor, output] = &mut self.encoders;
        if let Some(encoder) = motor {
            self.is_index |= encoder.convert(at_s, outputs);
        }
        if let Some(encoder) = output {
            encoder.convert(at_s, outputs);
        }
    }

    /// The supply under the motor's present current, added to the plant's outputs.
    pub(crate) fn load_supply(&mut self, outputs: &mut [f64], rows: SupplyRows) {
        let motor_a = self.current_row.map_or(0.0, |row| outputs[row]);
        let supply_a = self.duty.unwrap_or(0.0) * motor_a;
        self.supply_v = SUPPLY_V - SUPPLY_OHM * supply_a;
        (outputs[rows.voltage], outputs[rows.current]) = (self.supply_v, supply_a);
    }

    /// Angles of the encoders' shafts, rad.
    pub(crate) fn angles_rad(&self, outputs: &[f64]) -> [f64; 2] {
        self.encoders.each_ref().map(|encoder| encoder.as_ref().map_or(0.0, |own| outputs[own.row]))
    }

    /// Writes the encoders' samples to their channels.
    pub(crate) fn read(&self, counts: &mut [i32]) {
        for (encoder, pair) in self.encoders.iter().zip(counts.chunks_exact_mut(2)) {
            pair.copy_from_slice(&encoder.as_ref().map_or([0; 2], |own| own.encoder.sample()));
        }
    }

    /// The digital inputs since the last call: the first one is the index of the motor's encoder.
    pub(crate) fn inputs(&mut self) -> u8 {
        u8::from(std::mem::take(&mut self.is_index))
    }
}

/// The output row of a gearmotor board's channel; the driven quantity is row 0.
fn row_of(model: &Model, calibration: &Calibration, channel: GearmotorChannel) -> Option<usize> {
    let column = calibration.channels.get(channel.index())?.channel.column_name();
    model.outputs().position(|output| output.column == column).map(|row| row + 1)
}

/// An encoder on a shaft whose angle the plant knows.
struct VirtualEncoder {
    row: usize,
    counts_per_turn: f64,
    unevenness: f64,
    /// Time and position in counts at the last conversion.
    at_s: f64,
    position: f64,
    cell: i64,
    edge_ticks: u32,
    encoder: Encoder,
}

impl VirtualEncoder {
    fn new(row: usize, counts_per_turn: f64, unevenness: f64) -> Self {
        Self {
            row,
            counts_per_turn,
            unevenness,
            at_s: 0.0,
            // In the middle of a count.
            position: 0.5,
            cell: 0,
            edge_ticks: 0,
            encoder: Encoder::new(TICKS_PER_S, LOG2_CONVERSIONS),
        }
    }

    /// Takes a conversion; returns whether the shaft has begun another turn.
    fn convert(&mut self, at_s: f64, outputs: &[f64]) -> bool {
        let position = outputs[self.row] / TAU * self.counts_per_turn + 0.5;
        let cell = self.cell_of(position);
        let turned = cell.div_euclid(self.per_turn()) != self.cell.div_euclid(self.per_turn());
        if cell != self.cell {
            let edge = if cell > self.cell { cell } else { cell + 1 };
            let share = (self.edge(edge) - self.position) / (position - self.position);
            let edge_s = self.at_s + share.clamp(0.0, 1.0) * (at_s - self.at_s);
            self.edge_ticks = ticks(edge_s);
        }
        (self.at_s, self.position, self.cell) = (at_s, position, cell);
        let now_ticks = ticks(at_s);
        let age_ticks = now_ticks.wrapping_sub(self.edge_ticks);
        self.encoder.push(&EncoderReading { count: cell as i32, age_ticks, now_ticks });
        turned
    }

    /// The count whose edges a position lies between.
    fn cell_of(&self, position: f64) -> i64 {
        let cell = position.floor() as i64;
        if position < self.edge(cell) {
            cell - 1
        } else if position >= self.edge(cell + 1) {
            cell + 1
        } else {
            cell
        }
    }

    fn per_turn(&self) -> i64 {
        (self.counts_per_turn.abs().round() as i64).max(1)
    }

    /// The position of the lower edge of a count. Its displacement is the same at every turn.
    fn edge(&self, cell: i64) -> f64 {
        let mut bits = (cell.rem_euclid(self.per_turn()) as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let share = (bits >> 11) as f64 / (1u64 << 53) as f64;
        cell as f64 + self.unevenness * (2.0 * share - 1.0)
    }
}

fn ticks(at_s: f64) -> u32 {
    (at_s * f64::from(TICKS_PER_S)) as u64 as u32
}

#[cfg(test)]
mod tests {
    use socam_recording::ProfileFile;

    use super::*;
    use crate::{Truth, calibration_for};

    fn setup(hidden: &[&str]) -> Setup {
        let hidden: Vec<_> = hidden.iter().map(|text| text.parse().unwrap()).collect();
        let truth = Truth::new(&Model::builtin("gearmotor").unwrap(), &[], &hidden).unwrap();
        let calibration = calibration_for(&truth.model);
        Setup::new(truth, calibration, 1)
    }

    #[test]
    fn encoders_currents_and_voltages_of_a_run_agree_with_one_another() {
        let profile = ProfileFile { duration_s: 2.0, ..ProfileFile::open("gearmotor").unwrap() };
        let data = setup(&[]).record("run", &profile.profile(1000).unwrap(), 1000).unwrap();
        let column = |name: &str| data.load(&[name]).unwrap().columns[0].values().to_vec();
        let (angle, output) = (column("motor_angle_rad"), column("output_angle_rad"));
        let (speed, volts, amperes) =
            (column("motor_speed_rad_s"), column("motor_voltage_V"), column("motor_current_A"));
        // Behind the gear of 30 0.36 N m at most, and twice that after a step, twist a shaft of 40 N m/rad, and each encoder is off by a count of the output's, 0.0026 rad, at most.
        let apart = angle.iter().zip(&output).map(|(motor, output)| (motor / 30.0 - output).abs());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart > 0.002 && apart < 2.0 * 0.36 / 40.0 + 0.0026, "{apart} rad");
        assert!(angle.iter().fold(0.0, |most: f64, angle| most.max(angle.abs())) > 20.0);
        // 2.2 ohm and 0.011 V s/rad, but for the inductance and the time to which a speed belongs.
        let rest = (100..2000).map(|row| volts[row] - 2.2 * amperes[row] - 0.011 * speed[row]);
        let rms = (rest.map(|volts| volts * volts).sum::<f64>() / 1900.0).sqrt();
        assert!(rms < 0.25, "{rms} V");
        // The supply sags by 0.1 ohm, and stays above 11 V.
        let supply = column("supply_V");
        assert!(supply.iter().all(|volts| (11.0..12.1).contains(volts)));
        // A command acts an interval later, and half of each of two intervals is in a sample, but for the bridge's 50 us: a fifth of the time between
        // two conversions, of which the first in an interval weighs 1/32 where the triangle begins and 7/32 behind its middle.
        let command = column("command_V");
        let late = (100..2000).map(|row| {
            let [now, before, first] = [1, 2, 3].map(|back| command[row - back]);
            let rising = (before - first) / 32.0 + (now - before) * 7.0 / 32.0;
            volts[row] - 0.5 * (now + before) + 0.2 * rising
        });
        let late = late.map(f64::abs).fold(0.0, f64::max);
        assert!(late < 0.01, "{late} V");
    }

    #[test]
    fn a_bridge_that_is_off_lets_the_motor_coast_and_at_zero_volts_brakes_it() {
        let setup = setup(&[]);
        let plants = setup.plants().unwrap();
        let speed_after = |enabled: bool| {
            let mut bench = crate::bench::Bench::start(&setup, &plants).unwrap();
            let mut counts = [0; 8];
            for sample in 1..1000u32 {
                let at_s = f64::from(sample) * 1e-3;
                let drives = sample < 900;
                bench.command(if drives { 6.0 } else { 0.0 }, drives || enabled);
                bench.sample(at_s, &mut counts).unwrap();
            }
            f64::from(counts[1]) / 256.0 / 1024.0 * TAU
        };
        let (braked, coasted) = (speed_after(true), speed_after(false));
        assert!(braked < 120.0 && coasted > 250.0, "{braked} {coasted}");
    }

    #[test]
    fn a_transducer_reads_the_torque_of_the_output_shaft_with_its_conversions() {
        let calibration = Calibration::parse(&Calibration::gearmotor_torque_text()).unwrap();
        let setup = Setup { calibration, ..setup(&["coulomb_friction@load_bearing:torque=0.05"]) };
        let profile = socam_core::Profile {
            shape: socam_core::Shape::Constant { level_micro: 6_000_000 },
            duration_us: 2_000_000,
            ..ProfileFile::open("gearmotor").unwrap().profile(1000).unwrap()
        };
        let data = setup.record("run", &profile, 1000).unwrap();
        let column = data.load(&["output_torque_Nm"]).unwrap().columns[0].values().to_vec();
        let values: Vec<f64> = column.iter().copied().filter(|value| !value.is_nan()).collect();
        let per_second = values.len() as f64 / column.len() as f64 * 1e3;
        assert!((per_second - 80.0).abs() < 1.5, "{per_second}");
        let steady = &values[100..150];
        assert!(steady.iter().all(|value| (value - 0.05).abs() < 5e-4), "{steady:?}");
        // Noise of 58 codes, of which 2147484 are a newton metre.
        assert!(steady.windows(2).all(|pair| pair[0] != pair[1]));
    }
}
