//! Properties of a compiled formula that hold for all inputs: where it vanishes, in which parameters it is linear, how sharply it bends.

use super::tape::{Function, Operation, Tape};

impl Tape {
    /// Whether the formula is zero for all inputs, where the parameters for which `is_zero` holds are zero.
    pub(crate) fn vanishes(&self, is_zero: impl Fn(usize) -> bool) -> bool {
        let mut zero: Vec<bool> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let of = |operand: u8| zero[usize::from(operand)];
            let own = match *operation {
                Operation::Constant(number) => number == 0.0,
                Operation::Input(_) => false,
                Operation::Curve => self.curve.as_ref().is_none_or(|curve| curve.vanishes(&is_zero)),
                Operation::Parameter(parameter) => is_zero(usize::from(parameter)),
                Operation::Negative(a) | Operation::Divide(a, _) => of(a),
                Operation::ConstantPower(a, exponent) => exponent > 0.0 && of(a),
                Operation::Multiply(a, b) => of(a) || of(b),
                Operation::Add(a, b)
                | Operation::Subtract(a, b)
                | Operation::Min(a, b)
                | Operation::Max(a, b) => of(a) && of(b),
                Operation::Function(Function::Exp | Function::Log | Function::Cos, _)
                | Operation::Power(..) => false,
                Operation::Function(_, a) => of(a),
            };
            zero.push(own);
        }
        zero.last().copied().unwrap_or(true)
    }

    /// Whether the formula is linear in the parameters of `set` together (a bit for each parameter).
    fn is_linear_in(&self, set: u32) -> bool {
        let mut degrees: Vec<u32> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let of = |operand: u8| degrees[usize::from(operand)];
            let bent = |degree: u32| if degree == 0 { 0 } else { 2 };
            let own = match *operation {
                Operation::Constant(_) | Operation::Input(_) => 0,
                Operation::Parameter(parameter) => u32::from(set & (1 << parameter) != 0),
                Operation::Curve => {
                    let curve = self.curve.as_ref();
                    u32::from(curve.is_some_and(|curve| curve.depends_on(|own| set & (1 << own) != 0)))
                }
                Operation::Negative(a) | Operation::ConstantPower(a, 1.0) => of(a),
                Operation::Add(a, b) | Operation::Subtract(a, b) => of(a).max(of(b)),
                Operation::Multiply(a, b) => (of(a) + of(b)).min(2),
                Operation::Divide(a, b) => of(a).max(bent(of(b))),
                Operation::Power(a, b) | Operation::Min(a, b) | Operation::Max(a, b) => bent(of(a) + of(b)),
                Operation::ConstantPower(a, _) | Operation::Function(_, a) => bent(of(a)),
            };
            degrees.push(own);
        }
        degrees.last().is_none_or(|degree| *degree <= 1)
    }

    /// The fewest of `count` parameters in which the formula is linear and without which it is zero for all inputs, the first ones of the
    /// list where several sets do; empty if there are none.
    pub(crate) fn amplitudes(&self, count: usize) -> Vec<usize> {
        let mut sets: Vec<u32> = (1..1 << count).collect();
        // Among sets of one size, the one with the earlier parameters has the smaller number.
        sets.sort_by_key(|set| (set.count_ones(), *set));
        let found = sets
            .into_iter()
            .find(|set| self.is_linear_in(*set) && self.vanishes(|parameter| set & (1 << parameter) != 0));
        (0..count).filter(|parameter| found.is_some_and(|set| set & (1 << parameter) != 0)).collect()
    }

    /// Parameters that stand below a line of division themselves, as `b` in `speed/b`.
    pub(crate) fn divisors(&self) -> impl Iterator<Item = usize> + '_ {
        self.operations.iter().filter_map(|operation| match operation {
            Operation::Divide(_, below) => match self.operations[usize::from(*below)] {
                Operation::Parameter(parameter) => Some(usize::from(parameter)),
                _ => None,
            },
            _ => None,
        })
    }

    /// Whether an operation divides by zero or gives no finite number at these inputs and parameters.
    pub(crate) fn is_finite_at(&self, inputs: &[f64], parameters: &[f64]) -> bool {
        let values = self.values(inputs, parameters);
        let divides = |operation: &Operation| match operation {
            Operation::Divide(_, below) => values[usize::from(*below)] != 0.0,
            _ => true,
        };
        values.iter().all(|value| value.is_finite()) && self.operations.iter().all(divides)
    }

    /// Width of the range of the first input about zero in which a `tanh` or `atan` bends sharply, at `inputs` that are all zero; 0 if none
    /// does.
    pub(crate) fn transition(&self, inputs: &[f64], parameters: &[f64]) -> f64 {
        let values = self.values(inputs, parameters);
        let mut steepest = 0.0_f64;
        let mut slopes: Vec<f64> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let slope = |operand: u8| slopes[usize::from(operand)];
            let value = |operand: u8| values[usize::from(operand)];
            let own = match *operation {
                Operation::Input(0) => 1.0,
                Operation::Constant(_) | Operation::Input(_) | Operation::Parameter(_) => 0.0,
                Operation::Negative(a) => -slope(a),
                Operation::Add(a, b) => slope(a) + slope(b),
                Operation::Subtract(a, b) => slope(a) - slope(b),
                Operation::Multiply(a, b) => slope(a) * value(b) + value(a) * slope(b),
                Operation::Divide(a, b) => (slope(a) - value(a) / value(b) * slope(b)) / value(b),
                Operation::Function(Function::Tanh | Function::Atan, a) => {
                    steepest = if slope(a).is_finite() { steepest.max(slope(a).abs()) } else { steepest };
                    slope(a)
                }
                // What another function does to the input is no straight line into a tanh.
                Operation::Power(..)
                | Operation::ConstantPower(..)
                | Operation::Function(..)
                | Operation::Min(..)
                | Operation::Max(..)
                | Operation::Curve => 0.0,
            };
            slopes.push(own);
        }
        if steepest > 0.0 { 1.0 / steepest } else { 0.0 }
    }
}
