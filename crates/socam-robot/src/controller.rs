//! The model file of an axis whose motor a moteus or an ODrive drives.

use socam_model::effects::COULOMB_FRICTION;

use crate::error::{Result, RobotError};
use crate::joint::Sourced;
use crate::written::{ModelText, Parameter, plain, rounded};

/// N m/A of a motor of 1 rpm/V, by the current of a phase: 3/2 over the square root of 3, in rad/s.
pub(crate) const TORQUE_FACTOR: f64 = 1.5 * 60.0 / (1.732_050_807_568_877_2 * std::f64::consts::TAU);
/// V s/rad in N m/A: three phases make the torque, one has the voltage.
const BACK_EMF_OF_TORQUE: f64 = 2.0 / 3.0;

/// kg m² in N m/(rev/s²), the unit in which a controller states an inertia by turns.
pub(crate) const INERTIA_BY_TURNS: f64 = 1.0 / std::f64::consts::TAU;

/// Inertia of an axis that states none, at its motor, kg m²: that of a motor of 50 mm.
const INERTIA_KG_M2: f64 = 1e-4;
/// Inertia of a rotor that nothing tells from its load: too small to matter.
const ROTOR_KG_M2: f64 = 1e-7;
/// Time in which an axis whose damping is not stated comes to rest, s.
const COASTING_S: f64 = 2.0;
/// Friction of an axis, as a share of its largest torque.
const FRICTION_SHARE: f64 = 0.02;
/// A number that is not stated may be this many times larger or smaller.
const UNKNOWN: f64 = 1000.0;
/// A number of a setting may be this many times larger or smaller.
const STATED: f64 = 5.0;

/// What drives the model of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drive {
    /// The measured current of the motor, which is a torque.
    Current,
    /// The voltage at the motor's winding.
    Voltage,
    /// The reference of the controller's position loop.
    Reference,
}

/// A motor with its controller, as the controller's settings have it. Values are in the units of their settings.
#[derive(Debug, Clone)]
pub struct Controller {
    /// Name of the axis.
    pub name: String,
    /// The controller's maker.
    pub program: &'static str,
    /// What the model does not have, in sentences.
    pub left_out: Vec<String>,
    /// N m/A at the motor.
    pub(crate) torque_constant: Option<Sourced>,
    /// ohm and H of a phase.
    pub(crate) resistance: Option<Sourced>,
    pub(crate) inductance: Option<Sourced>,
    /// Turns of the rotor for one of the output, where they differ.
    pub(crate) ratio: Option<Sourced>,
    /// 1/s.
    pub(crate) position_gain: Option<Sourced>,
    /// N m/(rev/s).
    pub(crate) velocity_gain: Option<Sourced>,
    /// N m at the output.
    pub(crate) torque_limit: Option<Sourced>,
    /// kg m² at the output.
    pub(crate) inertia: Option<Sourced>,
    /// Counts of the encoder for a turn.
    pub(crate) counts: Option<Sourced>,
    /// How many settings the file has.
    pub(crate) settings: usize,
}

impl Controller {
    /// The model as a file of schema `socam.model/1`, and what it leaves out. `settings` is the name of the file of settings.
    ///
    /// # Errors
    /// When the settings lack what such a drive needs.
    pub fn model_file(&self, settings: &str, drive: Drive) -> Result<(String, Vec<String>)> {
        let left_out = self.left_out(drive);
        let about = format!("{} by the settings of its {} ({settings})", self.name, self.program);
        let mut writer = Writer {
            file: ModelText::new(&plain(&self.name), &about, true, &left_out),
            of: self,
            settings,
            // Settings of a position loop are the output's.
            has_gear: self.ratio.is_some() && drive != Drive::Reference,
        };
        writer.parameters(drive)?;
        writer.elements(drive);
        writer.channels(drive)?;
        Ok((writer.file.finish(), left_out))
    }

    fn left_out(&self, drive: Drive) -> Vec<String> {
        let mut all = self.left_out.clone();
        all.push("friction and damping: no setting tells them; start values with wide bounds".to_owned());
        if self.inertia.is_none() {
            all.push("the inertia: no setting tells it; a start value with wide bounds".to_owned());
        }
        let mut unused = |used: bool, what: &str, unit: &str, number: &Option<Sourced>| {
            if let Some(number) = number.as_ref().filter(|_| !used) {
                let (value, source) = (rounded(number.value, 6), &number.source);
                all.push(format!(
                    "the {what}, {value} {unit} ({source}): not in a model that {}",
                    drive.of()
                ));
            }
        };
        let (winding, servo) = (drive == Drive::Voltage, drive == Drive::Reference);
        unused(winding, "resistance", "ohm", &self.resistance);
        unused(winding, "inductance", "H", &self.inductance);
        unused(servo, "gain of the position", "1/s", &self.position_gain);
        unused(servo, "gain of the velocity", "N m/(rev/s)", &self.velocity_gain);
        unused(servo, "limit of the torque", "N m", &self.torque_limit);
        unused(!servo, "torque constant", "N m/A", &self.torque_constant);
        unused(!servo, "gear", "to 1", &self.ratio);
        if servo {
            let why = "the reference is the position alone";
            all.push(format!("feed-forward of velocity and torque beside the controller's reference: {why}"));
        }
        all.push(format!(
            "all other ones of the {} settings, which say nothing of the motion",
            self.settings
        ));
        all
    }
}

/// What pole pairs say to whoever reads a diagnosis.
pub(crate) fn pole_pairs(pairs: f64, source: &str) -> String {
    format!("{pairs} pole pairs ({source}): a ripple of the torque has an order that is a multiple of them")
}

impl Drive {
    fn of(self) -> &'static str {
        match self {
            Self::Current => "a current drives",
            Self::Voltage => "a voltage drives",
            Self::Reference => "a reference drives",
        }
    }
}

/// A model file in the making.
struct Writer<'c> {
    file: ModelText,
    of: &'c Controller,
    settings: &'c str,
    has_gear: bool,
}

/// Name of the motor's node, and of the one that the controller's position is about.
const ROTOR: &str = "rotor";
const OUTPUT: &str = "output";

impl<'c> Writer<'c> {
    /// A number of a setting.
    fn stated(&mut self, key: &str, number: &Sourced, unit: &str, fixed: bool) {
        let source = format!("{}: {}", self.settings, number.source);
        let bounds = (!fixed).then_some((number.value / STATED, number.value * STATED));
        self.file.parameter(&Parameter { key, value: number.value, unit, bounds, fixed, source: &source });
    }

    /// A number that no setting tells.
    fn unknown(&mut self, key: &str, value: f64, unit: &str, lowest: f64) {
        let source = "no setting tells it: start value";
        let bounds = Some((lowest, value * UNKNOWN));
        self.file.parameter(&Parameter { key, value, unit, bounds, fixed: false, source });
    }

    /// A setting without which such a drive is no model.
    fn needed(&self, what: &str, number: &'c Option<Sourced>, drive: Drive) -> Result<&'c Sourced> {
        number.as_ref().ok_or_else(|| {
            RobotError::Whole(format!(
                "states no {what} above zero, which a model that {} needs; calibrate the motor and write its settings again, or take another --drive",
                drive.of()
            ))
        })
    }

    fn parameters(&mut self, drive: Drive) -> Result<()> {
        let of = self.of;
        let turns = of.ratio.as_ref().map_or(1.0, |ratio| ratio.value);
        let inertia = of.inertia.as_ref().map_or(INERTIA_KG_M2 * turns * turns, |stated| stated.value);
        match &of.inertia {
            Some(stated) => self.stated("inertia", stated, "kg m2", false),
            None => self.unknown("inertia", inertia, "kg m2", inertia / UNKNOWN),
        }
        self.unknown("damping", inertia / COASTING_S, "N m s/rad", 0.0);
        let largest = of.torque_limit.as_ref().map_or(inertia * 100.0, |limit| limit.value);
        self.unknown("friction", FRICTION_SHARE * largest, "N m", 0.0);
        if let Some(ratio) = of.ratio.as_ref().filter(|_| self.has_gear) {
            self.stated("gear_ratio", ratio, "1", true);
            let source = "behind a rigid gear it is part of the inertia: write the data sheet's, where play or elasticity is at issue";
            let (key, value, unit) = ("rotor_inertia", ROTOR_KG_M2, "kg m2");
            self.file.parameter(&Parameter { key, value, unit, bounds: None, fixed: true, source });
        }
        match drive {
            Drive::Current => {}
            Drive::Voltage => {
                let constant = self.needed("torque constant", &of.torque_constant, drive)?;
                self.stated("resistance", self.needed("resistance", &of.resistance, drive)?, "ohm", false);
                if let Some(inductance) = &of.inductance {
                    self.stated("inductance", inductance, "H", false);
                }
                self.stated("torque_constant", constant, "N m/A", false);
                let back_emf = Sourced {
                    value: BACK_EMF_OF_TORQUE * constant.value,
                    source: format!("2/3 of the torque constant, of a phase ({})", constant.source),
                };
                self.stated("back_emf", &back_emf, "V s/rad", false);
            }
            Drive::Reference => {
                let position = self.needed("gain of the position", &of.position_gain, drive)?;
                let velocity = self.needed("gain of the velocity", &of.velocity_gain, drive)?;
                self.stated("position_gain", position, "1/s", true);
                self.stated("velocity_gain", velocity, "N m s/rev", true);
                let source = "the gain of the velocity is a torque's";
                let (key, value, unit) = ("drive_gain", 1.0, "1");
                self.file.parameter(&Parameter { key, value, unit, bounds: None, fixed: true, source });
                if let Some(limit) = &of.torque_limit {
                    self.stated("torque_limit", limit, "N m", false);
                }
            }
        }
        Ok(())
    }

    fn rotor(&self) -> &'static str {
        if self.has_gear { ROTOR } else { OUTPUT }
    }

    fn elements(&mut self, drive: Drive) {
        if self.has_gear {
            self.file.table("[[nodes]]", &[("name", ROTOR), ("inertia", "rotor_inertia")]);
        }
        self.file.table("[[nodes]]", &[("name", OUTPUT), ("inertia", "inertia")]);
        if self.has_gear {
            let keys = [("name", "gear"), ("from", ROTOR), ("to", OUTPUT), ("ratio", "gear_ratio")];
            self.file.table("[[gears]]", &keys);
        }
        let keys = [("name", "bearing"), ("at", OUTPUT), ("damping", "damping")];
        self.file.table("[[bearings]]", &keys);
        self.file.effect(&COULOMB_FRICTION, "bearing", &[("torque", "friction")]);
        match drive {
            Drive::Current => {}
            Drive::Voltage => {
                let mut keys = vec![
                    ("name", "winding"),
                    ("at", self.rotor()),
                    ("resistance", "resistance"),
                    ("torque_constant", "torque_constant"),
                    ("back_emf", "back_emf"),
                ];
                keys.extend(self.of.inductance.as_ref().map(|_| ("inductance", "inductance")));
                self.file.table("[[motors]]", &keys);
            }
            Drive::Reference => {
                let mut keys = vec![
                    ("name", "servo"),
                    ("at", OUTPUT),
                    ("position_gain", "position_gain"),
                    ("velocity_gain", "velocity_gain"),
                    ("drive_gain", "drive_gain"),
                ];
                keys.extend(self.of.torque_limit.as_ref().map(|_| ("limit", "torque_limit")));
                self.file.table("[servo]", &keys);
            }
        }
    }

    fn channels(&mut self, drive: Drive) -> Result<()> {
        match drive {
            Drive::Current => {
                let constant = self.needed("torque constant", &self.of.torque_constant, drive)?;
                self.file.channel("current", "input", "torque", self.rotor());
                self.file.line("column = \"current_A\"");
                let Sourced { value, source } = constant;
                self.file.line(format_args!("scale = {value:.9}   # N m/A; {}: {source}", self.settings));
            }
            Drive::Voltage => {
                self.file.channel("voltage", "input", "voltage", "winding");
                self.file.channel("current", "output", "current", "winding");
            }
            Drive::Reference => self.file.channel("reference", "input", "reference", "servo"),
        }
        self.file.channel("position", "output", "angle", OUTPUT);
        if let Some(counts) = &self.of.counts {
            let count_rad = std::f64::consts::TAU / counts.value;
            self.file.comment(&format!(
                "{} counts for a turn of the encoder ({}: {}): {count_rad:.2e} rad each",
                counts.value, self.settings, counts.source
            ));
        }
        Ok(())
    }
}
