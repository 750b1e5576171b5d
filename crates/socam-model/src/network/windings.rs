//! Voltages and currents of the windings of motors.

use super::motion::MotionMaps;
use crate::{Motor, Quantity, jet::Jet};

impl MotionMaps<'_, '_> {
    /// The voltage at a motor: the sum of the inputs there.
    pub(super) fn volts(&self, motor: &Motor) -> Jet {
        let mut row = self.nothing();
        for (index, input) in self.a.model.inputs().enumerate() {
            if input.quantity == Quantity::Voltage && input.at == motor.name {
                for (column, sign) in self.driving(index, input) {
                    let mut signed = self.gain(input);
                    signed.value *= sign;
                    signed.derivatives.iter_mut().for_each(|derivative| *derivative *= sign);
                    row.add_at(0, column, &signed);
                }
            }
        }
        row
    }

    /// Voltage less back-EMF.
    fn driving_volts(&self, motor: &Motor) -> Jet {
        let speed = self.a.node_row(motor.node).times(&self.velocity);
        self.volts(motor).minus(&speed.scaled(&self.a.scalar(motor.back_emf)))
    }

    /// The current of a motor: its state, or the value that follows from resistance, voltage and speed.
    pub(super) fn current(&self, index: usize, motor: &Motor) -> Jet {
        match self.currents[index] {
            Some(column) => {
                let mut row = self.nothing();
                row.add_at(0, column, &self.one());
                row
            }
            None => self.driving_volts(motor).scaled(&self.one().over(&self.a.scalar(motor.resistance))),
        }
    }

    /// Column and rate of a current that is a state.
    pub(super) fn current_rate(&self, index: usize, motor: &Motor) -> Option<(usize, Jet)> {
        let (column, inductance) = (self.currents[index]?, motor.inductance?);
        let drop = self.current(index, motor).scaled(&self.a.scalar(motor.resistance));
        let rate = self.driving_volts(motor).minus(&drop);
        Some((column, rate.scaled(&self.one().over(&self.a.scalar(inductance)))))
    }
}
