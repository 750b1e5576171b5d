//! `[[springs]]`, `[[gears]]`, `[[differentials]]`, `[[shafts]]`, `[[bearings]]`, `[[motors]]` and `[servo]`.

use super::{
    raw::{RawBearing, RawDifferential, RawGear, RawMotor, RawServo, RawShaft, RawSpring},
    reader::Reader,
};
use crate::{Bearing, Differential, Gear, ModelError, Motor, Servo, Shaft, Spring, effects::QuantityKind};

impl Reader<'_> {
    pub(super) fn spring(&mut self, raw: RawSpring) -> Result<Spring, ModelError> {
        self.declare(&raw.name)?;
        let to = if raw.to.get_ref() == "ground" { None } else { Some(self.node(&raw.to)?) };
        let from = self.node(&raw.from)?;
        if to == Some(from) {
            return self.fail(
                &raw.to,
                "a spring must join two different nodes; write another node, or to = \"ground\"",
            );
        }
        Ok(Spring {
            name: raw.name.into_inner(),
            from,
            to,
            stiffness: self.positive(&raw.stiffness, QuantityKind::Stiffness)?,
            damping: raw.damping.map(|name| self.positive(&name, QuantityKind::Damping)).transpose()?,
        })
    }

    pub(super) fn gear(&mut self, raw: RawGear) -> Result<Gear, ModelError> {
        self.declare(&raw.name)?;
        let ratio = self.parameter("ratio", &raw.ratio, QuantityKind::Ratio)?;
        if self.parameters[ratio].value == 0.0 {
            let message = format!(
                "ratio \"{}\" is 0, but a gear of ratio N turns its `to` node N times slower; write another value than 0",
                self.parameters[ratio].name
            );
            return self.fail(&raw.ratio, message);
        }
        Ok(Gear { from: self.node(&raw.from)?, to: self.node(&raw.to)?, ratio, name: raw.name.into_inner() })
    }

    pub(super) fn differential(&mut self, raw: RawDifferential) -> Result<Differential, ModelError> {
        self.declare(&raw.name)?;
        let ([first, second], 2) = (&raw.from[..], raw.factors.len()) else {
            return self.fail(&raw.name, "a differential has two nodes and two factors; write from = [\"NODE\", \"NODE\"] and factors = [\"PARAMETER\", \"PARAMETER\"]");
        };
        let from = [self.node(first)?, self.node(second)?];
        let factor = |reader: &mut Self, index: usize| {
            let factor = reader.parameter("factors", &raw.factors[index], QuantityKind::Ratio)?;
            if reader.parameters[factor].value == 0.0 {
                let message = "a differential's factor cannot be zero; a joint that one motor moves is a [[gears]] table";
                return reader.fail(&raw.factors[index], message);
            }
            Ok(factor)
        };
        let factors = [factor(self, 0)?, factor(self, 1)?];
        Ok(Differential { from, to: self.node(&raw.to)?, factors, name: raw.name.into_inner() })
    }

    pub(super) fn motor(&mut self, raw: RawMotor) -> Result<Motor, ModelError> {
        self.declare(&raw.name)?;
        let torque_constant = self.positive(&raw.torque_constant, QuantityKind::TorqueConstant)?;
        let back_emf = raw.back_emf.map(|name| self.positive(&name, QuantityKind::BackEmf)).transpose()?;
        Ok(Motor {
            node: self.node(&raw.at)?,
            resistance: self.positive(&raw.resistance, QuantityKind::Resistance)?,
            torque_constant,
            back_emf: back_emf.unwrap_or(torque_constant),
            inductance: raw
                .inductance
                .map(|name| self.positive(&name, QuantityKind::Inductance))
                .transpose()?,
            name: raw.name.into_inner(),
        })
    }

    pub(super) fn shaft(&mut self, raw: RawShaft) -> Result<Shaft, ModelError> {
        self.declare(&raw.name)?;
        Ok(Shaft { nodes: (self.node(&raw.from)?, self.node(&raw.to)?), name: raw.name.into_inner() })
    }

    pub(super) fn bearing(&mut self, raw: RawBearing) -> Result<Bearing, ModelError> {
        self.declare(&raw.name)?;
        let damping = raw.damping.map(|name| self.positive(&name, QuantityKind::Damping)).transpose()?;
        Ok(Bearing { node: self.node(&raw.at)?, damping, name: raw.name.into_inner() })
    }

    pub(super) fn servo(&mut self, raw: RawServo) -> Result<Servo, ModelError> {
        self.declare(&raw.name)?;
        Ok(Servo {
            node: self.node(&raw.at)?,
            position_gain: self.parameter("position_gain", &raw.position_gain, QuantityKind::Gain)?,
            velocity_gain: self.parameter("velocity_gain", &raw.velocity_gain, QuantityKind::Gain)?,
            drive_gain: self.parameter("drive_gain", &raw.drive_gain, QuantityKind::Gain)?,
            limit: raw.limit.map(|name| self.positive(&name, QuantityKind::Torque)).transpose()?,
            name: raw.name.into_inner(),
        })
    }
}
