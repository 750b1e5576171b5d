//! `[[effects]]`: places effects in the model, and changes the network where an effect requires it.

use super::{
    raw::{RawEffect, Reference},
    reader::Reader,
    wording::meant,
};
use crate::{
    EffectUse, Model, ModelError, Node, Parameter, Shaft, Site, Spring,
    effects::{self, ActsAt, Borrowed, CONTACT_DAMPING, Effect, EffectParameter, QuantityKind},
};

/// Default damping over stiffness of a gear's contact, s: an impact decays within a sample at 1 kHz.
const CONTACT_RELAXATION_S: f64 = 1e-4;

impl Reader<'_> {
    pub(super) fn effect(&mut self, raw: RawEffect, model: &mut Model) -> Result<(), ModelError> {
        let id = raw.effect.get_ref();
        let given = raw.parameters.0.iter().map(|(name, _)| name.get_ref().as_str());
        let acts_there = |effect: &Effect| model.places(effect).contains(&raw.at.get_ref().as_str());
        let own = model.candidate(id).map(|own| own.effect);
        let Some(effect) = own.or_else(|| effects::find_at(id, given, acts_there)) else {
            let known: Vec<_> = effects::CATALOGUE.iter().map(|effect| effect.id).collect();
            let meant = meant(id, known.iter().copied());
            let message = format!("there is no effect \"{id}\"{meant}; effects are {}", known.join(", "));
            return self.fail(&raw.effect, message);
        };
        let place = raw.at.get_ref().clone();
        if !model.places(effect).contains(&place.as_str()) {
            let (what, places) = (effect.acts_at.noun(), model.places(effect).join(", "));
            return self.fail(
                &raw.at,
                format!("{id} acts at {what}, and \"{place}\" is none; write at = one of {places}"),
            );
        }
        let known = |name: &str| effect.parameters.iter().any(|parameter| parameter.name == name);
        if let Some((name, _)) = raw.parameters.0.iter().find(|(name, _)| !known(name.get_ref())) {
            let names: Vec<&str> = effect.parameters.iter().map(|own| own.name).collect();
            let names = if effect.is_own() { names } else { effects::parameters_of(id) }.join(", ");
            return self.fail(name, format!("{id} has no parameter \"{}\"; it has {names}", name.get_ref()));
        }
        let mut indices = Vec::new();
        for parameter in effect.parameters {
            let given = raw.parameters.0.iter().find(|(name, _)| name.get_ref() == parameter.name);
            indices.push(match (given, parameter.default) {
                (Some((_, name)), _) => self.effect_parameter(name, parameter)?,
                (None, Some(_)) if parameter.name == CONTACT_DAMPING => {
                    let damping = CONTACT_RELAXATION_S * self.contact_stiffness;
                    self.default_of(&place, parameter, (damping, damping))
                }
                (None, Some(default)) => self.default_of(&place, parameter, default),
                (None, None) => {
                    let message = format!(
                        "{id} needs the parameter \"{0}\"; write parameters = {{ {0} = \"PARAMETER\" }}",
                        parameter.name
                    );
                    return self.fail(&raw.effect, message);
                }
            });
        }
        if !self.put(effect, place, indices, model) {
            return self.fail(&raw.at, format!("{id} cannot act at \"{}\"", raw.at.get_ref()));
        }
        Ok(())
    }

    /// Stiffness of a rigid contact, by the model's springs and inertias.
    pub(super) fn rigid_stiffness(&self, model: &Model) -> f64 {
        let value = |parameter: usize| self.parameters[parameter].value;
        let springs = model.springs.iter().filter(|spring| effects::is_part(&spring.name));
        let inertias = model.nodes.iter().filter_map(|node| node.inertia);
        effects::rigid_stiffness(springs.map(|spring| value(spring.stiffness)), inertias.map(value))
    }

    /// Adds an effect with its own parameters at a place; false where it cannot act there.
    pub(super) fn put(
        &mut self,
        effect: &'static Effect,
        place: String,
        own: Vec<usize>,
        model: &mut Model,
    ) -> bool {
        let mut indices = own;
        let Some(at) = self.site(effect, &place, &indices, model) else { return false };
        if let Some(borrowed) = effect.borrows {
            match (borrowed, at) {
                (Borrowed::Stiffness, Site::Spring(spring) | Site::Gear { contact: spring, .. }) => {
                    indices.push(model.springs[spring].stiffness);
                }
                (Borrowed::Contact, Site::Gear { contact, .. }) => {
                    indices.push(model.springs[contact].stiffness);
                    indices.extend(model.springs[contact].damping);
                }
                (Borrowed::Stiffness | Borrowed::Contact, _) => {}
                (Borrowed::Damping, _) => {
                    let bearing = model.bearings.iter().find(|bearing| bearing.name == place);
                    indices.extend(bearing.and_then(|bearing| bearing.damping));
                }
            }
        }
        model.effects.push(EffectUse { effect, place, at, parameters: indices });
        true
    }

    /// Index of a parameter of an effect; its bounds are narrowed to those of the effect.
    fn effect_parameter(&mut self, name: &Reference, own: &EffectParameter) -> Result<usize, ModelError> {
        let index = self.parameter(own.name, name, own.kind)?;
        let parameter = &mut self.parameters[index];
        let (least, most) = own.bounds;
        parameter.bounds = (parameter.bounds.0.max(least), parameter.bounds.1.min(most));
        if (least..=most).contains(&parameter.value) {
            return Ok(index);
        }
        let message = match most {
            f64::INFINITY => {
                format!("\"{}\" is {}, but it must be {least} or more", parameter.name, parameter.value)
            }
            _ => format!(
                "\"{}\" is {}, but it must lie within {least} .. {most}",
                parameter.name, parameter.value
            ),
        };
        self.fail(name, message)
    }

    /// The place of an effect as indices; changes the network where the effect requires it.
    fn site(&mut self, effect: &Effect, place: &str, own: &[usize], model: &mut Model) -> Option<Site> {
        match effect.acts_at {
            ActsAt::Node => model.nodes.iter().position(|node| node.name == place).map(Site::Node),
            ActsAt::Bearing => {
                let bearing = model.bearings.iter().find(|bearing| bearing.name == place)?;
                Some(Site::Node(bearing.node))
            }
            ActsAt::Spring => model.springs.iter().position(|spring| spring.name == place).map(Site::Spring),
            ActsAt::Channel => {
                model.channels.iter().position(|channel| channel.name == place).map(Site::Channel)
            }
            ActsAt::Shaft => {
                let index = model.shafts.iter().position(|shaft| shaft.name == place)?;
                let Shaft { name, nodes: (from, to) } = model.shafts.remove(index);
                let (stiffness, damping) = (own[0], Some(own[1]));
                model.springs.push(Spring { name, from, to: Some(to), stiffness, damping });
                Some(Site::Spring(model.springs.len() - 1))
            }
            ActsAt::Gear => {
                let index = model.gears.iter().position(|gear| gear.name == place)?;
                let fast = model.gears[index].from;
                let contact = self.split(index, model);
                // The parameters of backlash include the damping of the contact.
                if let Some(own_damping) = effect.parameters.iter().position(|p| p.name == CONTACT_DAMPING) {
                    model.springs[contact].damping = Some(own[own_damping]);
                }
                let slow = model.springs[contact].to?;
                Some(Site::Gear { fast, slow, contact })
            }
        }
    }

    /// Inserts a stiff spring behind a gear, unless it has one.
    fn split(&mut self, gear: usize, model: &mut Model) -> usize {
        let place = model.gears[gear].name.clone();
        let name = format!("{place}.contact");
        if let Some(spring) = model.springs.iter().position(|spring| spring.name == name) {
            return spring;
        }
        let slow = model.gears[gear].to;
        model.nodes.push(Node { name: format!("{place}.out"), inertia: None });
        model.gears[gear].to = model.nodes.len() - 1;
        let contact_stiffness = self.contact_stiffness;
        let mut own = |name: &'static str, kind: QuantityKind, value: f64| {
            let parameter = EffectParameter { name, kind, default: None, bounds: (0.0, f64::INFINITY) };
            self.default_of(&place, &parameter, (value, value))
        };
        let stiffness = own("contact_stiffness", QuantityKind::Stiffness, contact_stiffness);
        let damping =
            Some(own(CONTACT_DAMPING, QuantityKind::Damping, CONTACT_RELAXATION_S * contact_stiffness));
        let from = model.nodes.len() - 1;
        model.springs.push(Spring { name, from, to: Some(slow), stiffness, damping });
        model.springs.len() - 1
    }

    /// Index of a parameter that has its default because the file gives none. Two effects at one place share a default of the same name.
    fn default_of(&mut self, place: &str, parameter: &EffectParameter, default: (f64, f64)) -> usize {
        let name = format!("{place}.{}", parameter.name);
        let known = self.parameters.iter().position(|known| known.name == name);
        known.unwrap_or_else(|| self.add_default(place, parameter, default))
    }

    /// Adds a parameter that the file does not declare.
    pub(super) fn add_default(
        &mut self,
        place: &str,
        parameter: &EffectParameter,
        default: (f64, f64),
    ) -> usize {
        let value = if self.rotational { default.0 } else { default.1 };
        let unit = parameter.kind.unit(self.rotational);
        self.parameters.push(Parameter {
            name: format!("{place}.{}", parameter.name),
            value,
            unit: unit.into(),
            file_unit: unit.into(),
            file_factor: 1.0,
            bounds: parameter.bounds,
            fixed: true,
            source: "default".into(),
            prior: None,
        });
        self.parameters.len() - 1
    }
}
