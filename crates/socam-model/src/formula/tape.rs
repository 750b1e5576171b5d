//! A formula compiled to a list of operations, evaluated with exact derivatives by a forward and a backward pass, without allocation.

use super::{CURVE, Curve, FUNCTIONS, FormulaProblem, Step, What, check, parse, powers_of, unit_of};

/// Most operations of a compiled formula: the work space of an evaluation lies on the stack.
pub(crate) const MOST_OPERATIONS: usize = 120;

/// Units by which those of a formula over channels are called.
const USUAL_UNITS: [&str; 12] =
    ["1", "N m", "rad/s", "rad", "rad/s2", "N", "m/s", "m", "m/s2", "V", "A", "K"];

/// An operation; operands are indices of earlier operations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operation {
    Constant(f64),
    Input(u8),
    Parameter(u8),
    Negative(u8),
    Add(u8, u8),
    Subtract(u8, u8),
    Multiply(u8, u8),
    Divide(u8, u8),
    Power(u8, u8),
    /// A power with a constant exponent.
    ConstantPower(u8, f64),
    Function(Function, u8),
    Min(u8, u8),
    Max(u8, u8),
    /// The law's curve.
    Curve,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Function {
    Abs,
    Sign,
    Sqrt,
    Exp,
    Log,
    Sin,
    Cos,
    Tanh,
    Atan,
}

/// Functions of one argument, in the order of [`FUNCTIONS`].
const OF_ONE: [Function; 9] = [
    Function::Abs,
    Function::Sign,
    Function::Sqrt,
    Function::Exp,
    Function::Log,
    Function::Sin,
    Function::Cos,
    Function::Tanh,
    Function::Atan,
];

/// A compiled formula.
#[derive(Debug, PartialEq)]
pub struct Tape {
    pub(super) operations: Vec<Operation>,
    pub(super) curve: Option<Curve>,
}

impl Tape {
    /// Compiles steps; inputs and parameters are found by their names, and the name [`CURVE`] is the curve. `None` where a name is unknown, and for more than
    /// [`MOST_OPERATIONS`].
    pub(crate) fn new(
        steps: &[Step],
        inputs: &[&str],
        parameters: &[&str],
        curve: Option<Curve>,
    ) -> Option<Self> {
        let index = |names: &[&str], name: &str| {
            let at = names.iter().position(|known| *known == name)?;
            u8::try_from(at).ok()
        };
        let mut operations = Vec::with_capacity(steps.len());
        let mut stack: Vec<u8> = Vec::new();
        for step in steps {
            let operation = match &step.what {
                What::Number(number) => Operation::Constant(*number),
                What::Name(name) if name == "pi" => Operation::Constant(std::f64::consts::PI),
                What::Name(name) if name == CURVE && curve.is_some() => Operation::Curve,
                What::Name(name) => match index(inputs, name) {
                    Some(input) => Operation::Input(input),
                    None => Operation::Parameter(index(parameters, name)?),
                },
                What::Negative => {
                    let own = stack.pop()?;
                    match operations[usize::from(own)] {
                        Operation::Constant(number) => Operation::Constant(-number),
                        _ => Operation::Negative(own),
                    }
                }
                What::Binary(operator) => {
                    let right = stack.pop()?;
                    let left = stack.pop()?;
                    match (operator, operations[usize::from(right)]) {
                        ('+', _) => Operation::Add(left, right),
                        ('-', _) => Operation::Subtract(left, right),
                        ('*', _) => Operation::Multiply(left, right),
                        ('/', _) => Operation::Divide(left, right),
                        (_, Operation::Constant(exponent)) => Operation::ConstantPower(left, exponent),
                        _ => Operation::Power(left, right),
                    }
                }
                What::Call(function) => match (OF_ONE.get(*function), FUNCTIONS[*function].0) {
                    (Some(function), _) => Operation::Function(*function, stack.pop()?),
                    (None, name) => {
                        let right = stack.pop()?;
                        let left = stack.pop()?;
                        if name == "min" { Operation::Min(left, right) } else { Operation::Max(left, right) }
                    }
                },
            };
            if operations.len() == MOST_OPERATIONS {
                return None;
            }
            stack.push(u8::try_from(operations.len()).ok()?);
            operations.push(operation);
        }
        (stack.len() == 1).then_some(Self { operations, curve })
    }

    /// A formula over inputs (their names and SI units) that is in `unit`.
    ///
    /// ```
    /// use socam_model::formula::Tape;
    ///
    /// let power = Tape::over("abs(torque)*speed", &[("torque".into(), "N m"), ("speed".into(), "rad/s")], "N m rad/s")?;
    /// assert_eq!(power.value(&[-2.0, 3.0]), 6.0);
    /// # Ok::<(), socam_model::formula::FormulaProblem>(())
    /// ```
    ///
    /// # Errors
    /// [`FormulaProblem`] where the text is no formula, names what is no input, joins units that do not go together, is in another unit, or
    /// is too long.
    pub fn over(text: &str, inputs: &[(String, &str)], unit: &str) -> Result<Self, FormulaProblem> {
        let steps = parse(text)?;
        let of_input = |name: &str| inputs.iter().find(|(known, _)| known == name).map(|(_, unit)| *unit);
        let found = check(text, &steps, &USUAL_UNITS, &|name| powers_of(of_input(name)?))?;
        if !found.is(powers_of(unit).unwrap_or_default()) {
            let own = unit_of(found.powers(), &USUAL_UNITS);
            return Err(FormulaProblem::at(
                text,
                0,
                format!("it is in \"{own}\", and \"{unit}\" is expected"),
            ));
        }
        let names: Vec<&str> = inputs.iter().map(|(name, _)| name.as_str()).collect();
        let too_long =
            || FormulaProblem::at(text, 0, format!("it has more than {MOST_OPERATIONS} operations"));
        Self::new(&steps, &names, &[], None).ok_or_else(too_long)
    }

    /// Value of a formula without parameters, SI.
    #[must_use]
    pub fn value(&self, inputs: &[f64]) -> f64 {
        self.values(inputs, &[])[self.operations.len() - 1]
    }

    /// Value of each operation.
    pub(super) fn values(&self, inputs: &[f64], parameters: &[f64]) -> [f64; MOST_OPERATIONS] {
        let mut values = [0.0; MOST_OPERATIONS];
        for (index, operation) in self.operations.iter().enumerate() {
            let of = |operand: u8| values[usize::from(operand)];
            values[index] = match *operation {
                Operation::Constant(number) => number,
                Operation::Input(input) => inputs[usize::from(input)],
                Operation::Parameter(parameter) => parameters[usize::from(parameter)],
                Operation::Negative(a) => -of(a),
                Operation::Add(a, b) => of(a) + of(b),
                Operation::Subtract(a, b) => of(a) - of(b),
                Operation::Multiply(a, b) => of(a) * of(b),
                Operation::Divide(a, b) => of(a) / of(b),
                Operation::Power(a, b) => of(a).powf(of(b)),
                Operation::ConstantPower(a, exponent) => power(of(a), exponent),
                Operation::Function(function, a) => function.value(of(a)),
                Operation::Min(a, b) => of(a).min(of(b)),
                Operation::Max(a, b) => of(a).max(of(b)),
                Operation::Curve => self.curve_at(inputs, parameters).0,
            };
        }
        values
    }

    /// Value and slope of the curve.
    fn curve_at(&self, inputs: &[f64], parameters: &[f64]) -> (f64, f64) {
        self.curve.as_ref().map_or((0.0, 0.0), |curve| curve.evaluate(inputs[curve.input], parameters))
    }

    /// The formula's value. Its derivatives with respect to inputs and parameters are added to the two lists.
    pub(crate) fn evaluate(
        &self,
        (inputs, by_input): (&[f64], &mut [f64]),
        (parameters, by_parameter): (&[f64], &mut [f64]),
    ) -> f64 {
        let values = self.values(inputs, parameters);
        let mut adjoints = [0.0; MOST_OPERATIONS];
        let last = self.operations.len() - 1;
        adjoints[last] = 1.0;
        for (index, operation) in self.operations.iter().enumerate().rev() {
            let own = adjoints[index];
            // What has no influence here has none where its own derivative is infinite, either.
            if own == 0.0 {
                continue;
            }
            let of = |operand: u8| values[usize::from(operand)];
            let mut add = |operand: u8, derivative: f64| adjoints[usize::from(operand)] += own * derivative;
            match *operation {
                Operation::Constant(_) => {}
                Operation::Input(input) => by_input[usize::from(input)] += own,
                Operation::Parameter(parameter) => by_parameter[usize::from(parameter)] += own,
                Operation::Negative(a) => add(a, -1.0),
                Operation::Add(a, b) => {
                    add(a, 1.0);
                    add(b, 1.0);
                }
                Operation::Subtract(a, b) => {
                    add(a, 1.0);
                    add(b, -1.0);
                }
                Operation::Multiply(a, b) => {
                    add(a, of(b));
                    add(b, of(a));
                }
                Operation::Divide(a, b) => {
                    add(a, 1.0 / of(b));
                    add(b, -values[index] / of(b));
                }
                Operation::Power(a, b) => {
                    add(a, of(b) * of(a).powf(of(b) - 1.0));
                    let by_exponent = if values[index] == 0.0 { 0.0 } else { values[index] * of(a).ln() };
                    add(b, by_exponent);
                }
                Operation::ConstantPower(a, exponent) => add(a, exponent * power(of(a), exponent - 1.0)),
                Operation::Function(function, a) => add(a, function.derivative(of(a), values[index])),
                Operation::Min(a, b) => add(if of(a) <= of(b) { a } else { b }, 1.0),
                Operation::Max(a, b) => add(if of(a) >= of(b) { a } else { b }, 1.0),
                Operation::Curve => {
                    if let Some(curve) = &self.curve {
                        by_input[curve.input] += own * self.curve_at(inputs, parameters).1;
                        curve.add_derivatives(inputs[curve.input], own, by_parameter);
                    }
                }
            }
        }
        values[last]
    }
}

fn power(base: f64, exponent: f64) -> f64 {
    // Exponents are bounded, see `dimensions`.
    if exponent.fract() == 0.0 { base.powi(exponent as i32) } else { base.powf(exponent) }
}

impl Function {
    fn value(self, x: f64) -> f64 {
        match self {
            Self::Abs => x.abs(),
            Self::Sign => sign(x),
            Self::Sqrt => x.sqrt(),
            Self::Exp => x.exp(),
            Self::Log => x.ln(),
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tanh => x.tanh(),
            Self::Atan => x.atan(),
        }
    }

    /// Derivative at `x`, where the function is `value`; 0 at the corner of `abs`.
    fn derivative(self, x: f64, value: f64) -> f64 {
        match self {
            Self::Abs => sign(x),
            Self::Sign => 0.0,
            Self::Sqrt => 0.5 / value,
            Self::Exp => value,
            Self::Log => 1.0 / x,
            Self::Sin => x.cos(),
            Self::Cos => -x.sin(),
            Self::Tanh => 1.0 - value * value,
            Self::Atan => 1.0 / (1.0 + x * x),
        }
    }
}

/// Sign of a number; 0 at 0.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}
