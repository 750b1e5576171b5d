//! The drive between command and drivetrain: what the command voltage asks for, and how fast it follows.

use nalgebra::DMatrix;
use socam_core::scaling::MotorCalibration;
use socam_model::{ChannelTransform, Equations, Model, Quantity};

/// Speed follows its command within this time (first order, 80 Hz): fast enough to excite the couplings' resonances.
const SPEED_LAG_S: f64 = 2e-3;

/// The armature's current follows the voltage within this time. Without it the speed would kink at every step of the
/// converter, with an image of the command near the sampling frequency that no sensor of the bench resolves.
const ARMATURE_LAG_S: f64 = 2e-3;

/// A current loop: much faster than anything mechanical.
const TORQUE_LAG_S: f64 = 0.5e-3;

/// A reference generator: slow enough not to strike a stiff servo with every sample.
const REFERENCE_LAG_S: f64 = 5e-3;

/// The default motor gives way by so much per torque on its shaft, (rad/s)/(N m).
const DROOP: f64 = 1.5;

/// Torque per current of the default motor, N m/A: 85 V and 5.4 A at 1450 rpm (thesis, table 2.3).
const TORQUE_PER_CURRENT: f64 = 0.55;

/// A drive: the steady answer to a voltage, two lags in a row, and how it gives way under load.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// What the driven quantity settles at, without load.
    pub evaluate: Answer,
    /// Time constant of what is driven, s.
    pub lag_s: f64,
    /// Time constant of what drives it, s.
    pub armature_lag_s: f64,
    /// Speed lost per torque that the driven shaft carries, (rad/s)/(N m); 0 where that torque is not measured.
    pub droop: f64,
    /// N m per A, for a channel that measures the motor's current.
    pub torque_per_current: f64,
}

/// Steady driven quantity over voltage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    /// A motor whose speed is a line over the voltage, rad/s.
    Speed(MotorCalibration),
    /// A torque, force or position in proportion, SI per V.
    Proportional(f64),
}

impl Drive {
    /// A drive that suits a model's first input: the calibrated motor for a speed, 0.2 N m/V or 35.15 N/V (the gain of the EMPS
    /// axis) for a torque or force, 0.02 rad/V (m/V) for a servo's reference.
    pub fn for_model(model: &Model, motor: &MotorCalibration) -> Self {
        let rotates = model.motion == socam_model::Motion::Rotation;
        let quantity = model.inputs().next().map(|channel| channel.quantity);
        let (evaluate, lag_s) = match quantity {
            Some(Quantity::Speed) => (Answer::Speed(*motor), SPEED_LAG_S),
            Some(Quantity::Torque) if rotates => (Answer::Proportional(0.2), TORQUE_LAG_S),
            Some(Quantity::Torque) => (Answer::Proportional(35.1507), TORQUE_LAG_S),
            _ => (Answer::Proportional(0.02), REFERENCE_LAG_S),
        };
        Self {
            evaluate,
            lag_s,
            armature_lag_s: ARMATURE_LAG_S,
            droop: DROOP,
            torque_per_current: TORQUE_PER_CURRENT,
        }
    }

    /// What the driven quantity settles at for a voltage, SI.
    pub fn settles_at(&self, volts: f64) -> f64 {
        match self.evaluate {
            Answer::Speed(motor) => motor.speed_rad_s(volts),
            Answer::Proportional(gain) => gain * volts,
        }
    }
}

/// The drivetrain with its drive, as one system: the inputs are what the driven quantity should settle at, and a one that the
/// clocks run by; the outputs are the driven quantity and then the model's.
pub(crate) fn attach(drive: &Drive, model: &Model, equations: &Equations) -> Equations {
    let e = equations;
    let (states, outputs, ports) = (e.state.nrows(), e.output.nrows(), e.ports.len());
    let rate = 1.0 / drive.lag_s;
    let reaction = reaction_output(model).filter(|_| matches!(drive.evaluate, Answer::Speed(_)));

    // Behind the drivetrain's states stand what its inputs are: the driven quantity and the clocks; then what the armature asks of
    // the drive.
    let inputs = e.input.ncols();
    let (driven, armature) = (states, states + inputs);
    let all = armature + 1;
    let mut state = DMatrix::zeros(all, all);
    state.view_mut((0, 0), (states, states)).copy_from(&e.state);
    state.view_mut((0, states), (states, inputs)).copy_from(&e.input);
    state[(driven, driven)] = -rate;
    state[(driven, armature)] = rate;
    state[(armature, armature)] = -1.0 / drive.armature_lag_s;
    let mut force = DMatrix::zeros(all, ports);
    force.view_mut((0, 0), (states, ports)).copy_from(&e.force);
    if let Some(row) = reaction {
        let yields = -drive.droop * rate;
        state.view_mut((states, 0), (1, states)).copy_from(&(e.output.row(row) * yields));
        let through = e.feedthrough.row(row) * yields;
        let mut own = state.view_mut((states, states), (1, inputs));
        own += through;
        force.view_mut((states, 0), (1, ports)).copy_from(&(e.force_output.row(row) * yields));
    }
    let mut input = DMatrix::zeros(all, 2);
    input[(armature, 0)] = 1.0 / drive.armature_lag_s;
    for (index, clock) in model.inputs().enumerate().filter(|(_, input)| input.quantity.is_clock()) {
        let row = states + index;
        let tachometer = model.outputs().position(|output| output.column == clock.column);
        match (clock.quantity, tachometer) {
            (Quantity::Time, _) => input[(row, 1)] = 1.0,
            (_, Some(output)) => {
                state.view_mut((row, 0), (1, states)).copy_from(&e.output.row(output));
                state.view_mut((row, states), (1, inputs)).copy_from(&e.feedthrough.row(output));
                force.view_mut((row, 0), (1, ports)).copy_from(&e.force_output.row(output));
            }
            (_, None) => state[(row, driven)] = 1.0,
        }
    }

    let mut output = DMatrix::zeros(outputs + 1, all);
    output[(0, driven)] = 1.0;
    output.view_mut((1, 0), (outputs, states)).copy_from(&e.output);
    output.view_mut((1, states), (outputs, inputs)).copy_from(&e.feedthrough);
    let mut force_output = DMatrix::zeros(outputs + 1, ports);
    force_output.view_mut((1, 0), (outputs, ports)).copy_from(&e.force_output);
    let mut port = DMatrix::zeros(ports, all);
    port.view_mut((0, 0), (ports, states)).copy_from(&e.port);
    port.view_mut((0, states), (ports, inputs)).copy_from(&e.port_input);

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

/// The output that measures the torque on the driven shaft, if there is one.
pub(crate) fn reaction_output(model: &Model) -> Option<usize> {
    let driven = &model.inputs().next()?.at;
    let node = model.nodes.iter().position(|node| node.name == *driven)?;
    let on_it = |at: &str| model.springs.iter().any(|spring| spring.name == at && spring.from == node);
    model.outputs().position(|channel| channel.quantity == Quantity::Torque && on_it(&channel.at))
}
