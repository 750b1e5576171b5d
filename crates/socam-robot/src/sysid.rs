//! Gains of WPILib's SysId: V = kS sign(speed) + kV speed + kA acceleration, and kG against gravity.

use std::f64::consts::FRAC_PI_2;

use socam_model::effects::{CONSTANT_LOAD, COULOMB_FRICTION, GRAVITY_UNBALANCE};

use crate::error::{Result, RobotError};
use crate::written::{ModelText, Parameter, plain};

/// A gain may be this many times larger or smaller.
const RANGE: f64 = 10.0;
/// Weight of which the bounds of a lighter one are made, V.
const LEAST_WEIGHT_V: f64 = 0.1;
/// Units of SysId: their names, the unit of the model file (by its letters in `V s/...`), its size in that, and whether it is an angle.
const UNITS: [(&[&str], &str, f64, bool); 6] = [
    (&["rotations", "rotation", "rot", "revolutions", "rev", "turns", "turn"], "rev", 1.0, true),
    (&["radians", "radian", "rad"], "rad", 1.0, true),
    (&["degrees", "degree", "deg"], "deg", 1.0, true),
    (&["meters", "metres", "meter", "metre", "m"], "m", 1.0, false),
    (&["feet", "foot", "ft"], "m", 0.3048, false),
    (&["inches", "inch", "in"], "m", 0.0254, false),
];

/// A mechanism of SysId.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mechanism {
    Simple,
    Elevator,
    Arm,
}

/// Gains as SysId shows them.
#[derive(Debug, Clone, PartialEq)]
pub struct SysId {
    mechanism: Mechanism,
    /// Index into `UNITS`.
    unit: usize,
    /// V.
    ks: f64,
    /// V s/unit.
    kv: f64,
    /// V s²/unit.
    ka: f64,
    /// V.
    kg: f64,
    /// rad, of an arm: its angle from the horizontal where it reads zero.
    offset: f64,
}

fn refused(problem: String) -> RobotError {
    RobotError::Whole(format!(
        "the gains {problem}; expected such as `ks=0.12 kv=0.8 ka=0.03 unit=rotations`"
    ))
}

/// The words of gains.
#[derive(Default)]
struct Words {
    /// ks, kv, ka, kg and offset.
    gains: [Option<f64>; 5],
    unit: Option<String>,
    mechanism: Option<String>,
}

impl Words {
    fn read(text: &str) -> Result<Self> {
        let spaced = text.replace([',', ';', '\n', '\t'], " ").replace(':', "=");
        let text = spaced.replace(" =", "=").replace("= ", "=").to_ascii_lowercase();
        let mut words = Self::default();
        for word in text.split_whitespace() {
            let pair = word.split_once('=');
            let (name, value) =
                pair.ok_or_else(|| refused(format!("hold `{word}`, which is no `name=value`")))?;
            match name {
                "unit" | "units" => words.unit = Some(value.to_owned()),
                "mechanism" | "test" => words.mechanism = Some(value.to_owned()),
                name => {
                    let at = ["ks", "kv", "ka", "kg", "offset"].iter().position(|known| *known == name);
                    let at = at.ok_or_else(|| refused(format!("hold `{name}`, which is none of SysId's")))?;
                    let number = value.parse::<f64>().ok().filter(|number| number.is_finite());
                    let number =
                        number.ok_or_else(|| refused(format!("hold `{word}`, whose value is no number")));
                    words.gains[at] = Some(number?);
                }
            }
        }
        Ok(words)
    }

    /// Index of the unit in `UNITS`.
    fn unit(&self) -> Result<usize> {
        let unit = self.unit.as_deref().ok_or_else(|| refused("have no `unit`".into()))?;
        UNITS.iter().position(|(names, ..)| names.contains(&unit)).ok_or_else(|| {
            refused(format!(
                "are by `{unit}`; SysId has rotations, radians, degrees, meters, feet and inches"
            ))
        })
    }

    fn mechanism(&self) -> Result<Mechanism> {
        match self.mechanism.as_deref().unwrap_or("simple") {
            "simple" => Ok(Mechanism::Simple),
            "elevator" => Ok(Mechanism::Elevator),
            "arm" => Ok(Mechanism::Arm),
            other => Err(refused(format!("are of `{other}`; SysId has simple, elevator and arm"))),
        }
    }
}

impl SysId {
    /// Reads words such as `ks=0.12 kv=0.8 ka=0.03 unit=rotations mechanism=arm kg=0.4 offset=0.1`.
    ///
    /// # Errors
    /// One sentence that says what is missing or wrong.
    pub fn parse(text: &str) -> Result<Self> {
        let words = Words::read(text)?;
        let [ks, kv, ka, kg, offset] = words.gains;
        let needed = |gain: Option<f64>, name: &str| gain.ok_or_else(|| refused(format!("have no `{name}`")));
        let (ks, kv, ka) = (needed(ks, "ks")?, needed(kv, "kv")?, needed(ka, "ka")?);
        if ks < 0.0 || kv <= 0.0 || ka <= 0.0 {
            return Err(refused(format!(
                "have ks = {ks}, kv = {kv}, ka = {ka}: no machine has a negative ks, or kv or ka of zero or less"
            )));
        }
        let (unit, mechanism) = (words.unit()?, words.mechanism()?);
        let problem = match (mechanism, kg, UNITS[unit].3) {
            (Mechanism::Simple, Some(_), _) => "have a kg; add mechanism=elevator or mechanism=arm",
            (Mechanism::Elevator | Mechanism::Arm, None, _) => {
                "have no `kg`, which an elevator or an arm has"
            }
            (Mechanism::Arm, Some(kg), _) if kg < 0.0 => {
                "have a kg below zero, for which the offset of an arm stands"
            }
            (Mechanism::Arm, _, false) => "are of an arm, whose unit is rotations, radians or degrees",
            _ => {
                let (kg, offset) = (kg.unwrap_or(0.0), offset.unwrap_or(0.0));
                return Ok(Self { mechanism, unit, ks, kv, ka, kg, offset });
            }
        };
        Err(refused(problem.to_owned()))
    }

    /// Name of the mechanism, which the model has too.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self.mechanism {
            Mechanism::Simple => "mechanism",
            Mechanism::Elevator => "elevator",
            Mechanism::Arm => "arm",
        }
    }

    /// What the gains do not determine, in sentences.
    #[must_use]
    pub fn left_out(&self) -> Vec<String> {
        let unit = if UNITS[self.unit].3 { "N m" } else { "N" };
        vec![
            format!(
                "how much torque a volt makes: no voltage tells it, and 1 {unit}/V stands for it. With kt/R of the motors at the mechanism (torque constant times gear, over the resistance) inertia, friction and weight are kt/R times those of the file"
            ),
            "viscous friction: kV has it and the back-EMF together".to_owned(),
            "the current, its limit and the inductance of the winding".to_owned(),
        ]
    }

    /// The model as a file of schema `socam.model/1`.
    #[must_use]
    pub fn model_file(&self) -> String {
        let (names, unit, size, turns) = UNITS[self.unit];
        let name = plain(self.name());
        let about = format!("Gains of SysId, {}, by {}", self.name(), names[0]);
        let mut file = ModelText::new(&name, &about, turns, &self.left_out());
        self.parameters(&mut file, (unit, size, turns));
        let node = [("name", name.as_str()), ("inertia", "kA")];
        file.table("[[nodes]]", &node);
        file.table("[[bearings]]", &[("name", "bearing"), ("at", &name)]);
        let motor = [
            ("name", "motor"),
            ("at", &name),
            ("resistance", "resistance"),
            ("torque_constant", "torque_constant"),
            ("back_emf", "kV"),
        ];
        file.table("[[motors]]", &motor);
        if self.ks > 0.0 {
            file.effect(&COULOMB_FRICTION, "bearing", &[("torque", "kS")]);
        }
        match self.mechanism {
            Mechanism::Simple => {}
            Mechanism::Elevator => file.effect(&CONSTANT_LOAD, &name, &[("torque", "kG")]),
            Mechanism::Arm => {
                file.effect(&GRAVITY_UNBALANCE, &name, &[("torque", "kG"), ("phase", "horizontal")]);
            }
        }
        file.channel("voltage", "input", "voltage", "motor");
        let (position, speed) = if turns { ("angle", "rad") } else { ("position", "m") };
        file.channel("position", "output", position, &name);
        file.comment("Where the velocity was recorded instead:");
        file.comment(&format!("[channels.velocity] quantity = \"speed\", column velocity_{speed}_s"));
        file.finish()
    }

    fn parameters(&self, file: &mut ModelText, (unit, size, turns): (&str, f64, bool)) {
        let per_volt = if turns { "1 N m/V" } else { "1 N/V" };
        let by = UNITS[self.unit].0[0];
        let mut gain = |key: &str, stated: f64, value: f64, unit: &str, source: &str, bounds| {
            let source = format!("SysId: {key} = {stated} {source}");
            file.parameter(&Parameter {
                key,
                value,
                unit,
                bounds: Some(bounds),
                fixed: false,
                source: &source,
            });
        };
        let about = |value: f64| (value / RANGE, value * RANGE);
        let (kv, ka) = (self.kv / size, self.ka / size);
        let force = if turns { "N m" } else { "N" };
        gain(
            "kA",
            self.ka,
            ka,
            &format!("{force} s2/{unit}"),
            &format!("V s2 by {by}, at {per_volt}"),
            about(ka),
        );
        gain("kV", self.kv, kv, &format!("V s/{unit}"), &format!("V s by {by}"), about(kv));
        if self.ks > 0.0 {
            gain("kS", self.ks, self.ks, force, &format!("V, at {per_volt}"), (0.0, RANGE * self.ks));
        }
        if self.mechanism != Mechanism::Simple {
            let largest = RANGE * self.kg.abs().max(LEAST_WEIGHT_V);
            let lowest = if self.mechanism == Mechanism::Arm { 0.0 } else { -largest };
            gain("kG", self.kg, self.kg, force, &format!("V, at {per_volt}"), (lowest, largest));
        }
        if self.mechanism == Mechanism::Arm {
            let source = "SysId counts the angle of an arm from the horizontal, where the recording begins at its zero";
            let (key, value, unit) = ("horizontal", FRAC_PI_2 + self.offset, "rad");
            file.parameter(&Parameter { key, value, unit, bounds: None, fixed: false, source });
        }
        let source = format!("{per_volt}, which no gain tells");
        for (key, unit) in [("resistance", "ohm"), ("torque_constant", if turns { "N m/A" } else { "N/A" })] {
            file.parameter(&Parameter { key, value: 1.0, unit, bounds: None, fixed: true, source: &source });
        }
    }
}
