//! The drive between command voltage and drivetrain: its steady characteristic and its lags.

use nalgebra::DMatrix;
use socam_core::scaling::MotorCalibration;
use socam_model::{ChannelTransform, Equations, Model, Quantity};

/// Time constant of the speed (first order, 80 Hz): fast enough to excite the couplings' resonances.
const SPEED_LAG_S: f64 = 2e-3;

/// Time constant of the armature. Without it the speed would have a corner at every step of the converter, with an image of the
/// command near the sampling frequency that no sensor of the bench resolves.
const ARMATURE_LAG_S: f64 = 2e-3;

/// Time constant of a current loop: much shorter than those of the mechanics.
const TORQUE_LAG_S: f64 = 0.5e-3;

/// Time constant of an H-bridge that is modulated at 20 kHz, twice in series.
const BRIDGE_LAG_S: f64 = 25e-6;

/// Time constant of a reference generator: long enough not to excite a stiff servo at every sample.
const REFERENCE_LAG_S: f64 = 5e-3;

/// Speed that the default motor loses per torque on its shaft, (rad/s)/(N m).
const DROOP: f64 = 1.5;

/// Torque per current of the default motor, N m/A: 85 V and 5.4 A at 1450 rpm (thesis, table 2.3).
const TORQUE_PER_CURRENT: f64 = 0.55;

/// A drive: steady characteristic, two lags in series, and droop under load.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Steady driven quantity without load.
    pub answer: Answer,
    /// Time constant of the driven quantity, s.
    pub lag_s: f64,
    /// Time constant of the armature, s.
    pub armature_lag_s: f64,
    /// Decrease of the speed per torque on the driven shaft, (rad/s)/(N m); 0 if that torque is not measured.
    pub droop: f64,
    /// N m per A, for a channel that measures the motor's current.
    pub torque_per_current: f64,
}

/// Steady driven quantity over voltage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    /// A motor whose speed is linear in the voltage, rad/s.
    Speed(MotorCalibration),
    /// A torque, force or position proportional to the voltage, SI per V.
    Proportional(f64),
}

impl Drive {
    /// A drive that suits a model's first input: the calibrated motor for a speed, 0.2 N m/V or 35.15 N/V (the gain of the EMPS
    /// axis) for a torque or force, the voltage itself for a winding, 0.02 rad/V (m/V) for a servo's reference.
    pub fn for_model(model: &Model, motor: &MotorCalibration) -> Self {
        let rotates = model.motion == socam_model::Motion::Rotation;
        let quantity = model.inputs().next().map(|channel| channel.quantity);
        let (answer, lag_s) = match quantity {
            Some(Quantity::Speed) => (Answer::Speed(*motor), SPEED_LAG_S),
            Some(Quantity::Torque) if rotates => (Answer::Proportional(0.2), TORQUE_LAG_S),
            Some(Quantity::Torque) => (Answer::Proportional(35.1507), TORQUE_LAG_S),
            Some(Quantity::Voltage) => (Answer::Proportional(1.0), TORQUE_LAG_S),
            _ => (Answer::Proportional(0.02), REFERENCE_LAG_S),
        };
        Self {
            answer,
            lag_s,
            armature_lag_s: ARMATURE_LAG_S,
            droop: DROOP,
            torque_per_current: TORQUE_PER_CURRENT,
        }
    }

    /// An H-bridge: its average voltage follows the command within a period of its modulation.
    pub fn bridge() -> Self {
        Self {
            answer: Answer::Proportional(1.0),
            lag_s: BRIDGE_LAG_S,
            armature_lag_s: BRIDGE_LAG_S,
            droop: 0.0,
            torque_per_current: TORQUE_PER_CURRENT,
        }
    }

    /// Steady driven quantity at a voltage, SI.
    pub fn settles_at(&self, volts: f64) -> f64 {
        match self.answer {
            Answer::Speed(motor) => motor.speed_rad_s(volts),
            Answer::Proportional(gain) => gain * volts,
        }
    }
}

/// The motor whose voltage a model's first input is.
pub(crate) fn driven_motor(model: &Model) -> Option<usize> {
    let driven = &model.inputs().next()?.at;
    model.motors.iter().position(|motor| motor.name == *driven)
}

/// The drivetrain with its drive, as one system. Inputs: the steady driven quantity, and a constant 1 that the clocks integrate.
/// Outputs: the driven quantity, then the model's.
pub(crate) fn attach(drive: &Drive, model: &Model, equations: &Equations) -> Equations {
    let e = equations;
    let (states, outputs, ports) = (e.state.nrows(), e.output.nrows(), e.ports.len());
    let rate = 1.0 / drive.lag_s;
    let reaction = reaction_output(model).filter(|_| matches!(drive.answer, Answer::Speed(_)));

    // The drivetrain's states come first, then its inputs as states (the driven quantity and the clocks), then the armature.
    let inputs = e.input.ncols();
    let (driven, armature) = (states, states + inputs);
    let all = armature + 1;
    let mut state = beside(&e.state, &e.input, all).resize_vertically(all, 0.0);
    state[(driven, driven)] = -rate;
    state[(driven, armature)] = rate;
    state[(armature, armature)] = -1.0 / drive.armature_lag_s;
    let mut force = e.force.clone().resize_vertically(all, 0.0);
    if let Some(row) = reaction {
        add_output(e, row, -drive.droop * rate, (&mut state, &mut force), driven);
    }
    let mut input = DMatrix::zeros(all, 2);
    input[(armature, 0)] = 1.0 / drive.armature_lag_s;
    for (index, clock) in model.inputs().enumerate().filter(|(_, input)| input.quantity.is_clock()) {
        let row = states + index;
        let tachometer = model.outputs().position(|output| output.column == clock.column);
        match (clock.quantity, tachometer) {
            (Quantity::Time, _) => input[(row, 1)] = 1.0,
            (_, Some(output)) => add_output(e, output, 1.0, (&mut state, &mut force), row),
            (_, None) => state[(row, driven)] = 1.0,
        }
    }

    let mut output = beside(&e.output, &e.feedthrough, all).insert_row(0, 0.0);
    output[(0, driven)] = 1.0;
    let force_output = e.force_output.clone().insert_row(0, 0.0);
    let port = beside(&e.port, &e.port_input, all);

    let driving = (0..inputs).map(|index| if index == 0 { "speed of the drive" } else { "clock" });
    let drive_states = driving.chain(["speed that its armature asks for"]).map(str::to_owned);
    Equations {
        state,
        input,
        force,
        output,
        feedthrough: DMatrix::zeros(outputs + 1, 2),
        force_output,
        port,
        port_input: DMatrix::zeros(ports, 2),
        port_force: e.port_force.clone(),
        ports: e.ports.clone(),
        state_names: e.state_names.iter().cloned().chain(drive_states).collect(),
        transforms: vec![ChannelTransform::Value; 2],
    }
}

/// Two blocks side by side, padded with zero columns.
fn beside(left: &DMatrix<f64>, right: &DMatrix<f64>, columns: usize) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(left.nrows(), columns);
    all.columns_mut(0, left.ncols()).copy_from(left);
    all.columns_mut(left.ncols(), right.ncols()).copy_from(right);
    all
}

/// Adds an output of the drivetrain, times a factor, to the rate of a state.
fn add_output(
    equations: &Equations,
    output: usize,
    factor: f64,
    (state, force): (&mut DMatrix<f64>, &mut DMatrix<f64>),
    row: usize,
) {
    let e = equations;
    let (states, inputs, ports) = (e.output.ncols(), e.feedthrough.ncols(), e.force_output.ncols());
    let mut of_states = state.view_mut((row, 0), (1, states));
    of_states += e.output.row(output) * factor;
    let mut of_inputs = state.view_mut((row, states), (1, inputs));
    of_inputs += e.feedthrough.row(output) * factor;
    let mut of_ports = force.view_mut((row, 0), (1, ports));
    of_ports += e.force_output.row(output) * factor;
}

/// The output that measures the torque on the driven shaft, if there is one.
pub(crate) fn reaction_output(model: &Model) -> Option<usize> {
    let driven = &model.inputs().next()?.at;
    let node = model.nodes.iter().position(|node| node.name == *driven)?;
    let on_it = |at: &str| model.springs.iter().any(|spring| spring.name == at && spring.from == node);
    model.outputs().position(|channel| channel.quantity == Quantity::Torque && on_it(&channel.at))
}
