//! The model file: TOML in, a checked [`Model`] in SI out, every complaint with its line.

use toml::Spanned;

use crate::{
    Bearing, Channel, EffectUse, Gear, Model, ModelError, Motion, Node, Parameter, Prior, Quantity, Role,
    Servo, Shaft, Site, Spring, Take,
    effects::{self, ActsAt, Borrowed, Effect, Kind, LawInput},
    model::{CONTACT_DAMPING, CONTACT_RELAXATION_S},
    units,
};

use raw::{
    List, Name, RawBearing, RawEffect, RawGear, RawModel, RawParameter, RawServo, RawShaft, RawSpring,
    Reference, Written,
};

mod channel;
#[cfg(test)]
mod documented;
mod raw;
#[cfg(test)]
mod tests;
mod wiring;

pub use channel::column_unit;

const SCHEMA: &str = "socam.model/1";

pub(crate) fn read(text: &str) -> Result<Model, ModelError> {
    let raw: RawModel = toml::from_str(text).map_err(|error| {
        let line = line_of(text, error.span().map_or(0, |span| span.start));
        ModelError::File { line, message: error.message().trim().replace('\n', ", ") }
    })?;
    Reader {
        text,
        rotational: raw.motion == Motion::Rotation,
        parameters: Vec::new(),
        bounded: Vec::new(),
        nodes: Vec::new(),
        places: Vec::new(),
        contact_stiffness: 0.0,
    }
    .model(raw)
}

/// The model with an effect that no file can name; `None` where it cannot act there.
pub(crate) fn put(model: &Model, effect: &'static Effect, place: &str, values: &[f64]) -> Option<Model> {
    let mut model = model.clone();
    if !model.places(effect).contains(&place) || values.len() != effect.parameters.len() {
        return None;
    }
    let mut reader = Reader {
        text: "",
        rotational: model.motion == Motion::Rotation,
        parameters: std::mem::take(&mut model.parameters),
        bounded: Vec::new(),
        nodes: Vec::new(),
        places: Vec::new(),
        contact_stiffness: 0.0,
    };
    reader.contact_stiffness = reader.rigid_stiffness(&model);
    let own = effect.parameters.iter().zip(values);
    let own = own.map(|(parameter, value)| reader.add_default(place, parameter, (*value, *value))).collect();
    let fits = reader.put(effect, place.into(), own, &mut model);
    model.parameters = reader.parameters;
    model.channels.retain(|channel| !channel.quantity.is_clock());
    add_clocks(&mut model);
    fits.then_some(model)
}

fn line_of(text: &str, offset: usize) -> usize {
    text.as_bytes().iter().take(offset).filter(|byte| **byte == b'\n').count() + 1
}

/// An error of the network as one of its file: at the line that declares the first name it speaks of.
pub(crate) fn placed(text: &str, error: ModelError) -> ModelError {
    let message = match &error {
        ModelError::File { .. } => return error,
        ModelError::Network(_) | ModelError::Value { .. } => error.to_string(),
    };
    let declares = |line: &str, name: &str| {
        let line = line.trim();
        let key = line.split_once('=').map(|(key, value)| (key.trim(), value.trim().trim_matches('"')));
        line.strip_prefix("[channels.").is_some_and(|rest| rest.trim_end_matches(']') == name)
            || key.is_some_and(|(key, value)| key == name || (key == "name" && value == name))
    };
    let is_part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
    let mut names = message.split(|c| !is_part(c)).filter(|name| !name.is_empty());
    match names.find_map(|name| text.lines().position(|line| declares(line, name))) {
        Some(index) => ModelError::File { line: index + 1, message },
        None => error,
    }
}

/// Names that were declared so far, while the file is being read.
struct Reader<'t> {
    text: &'t str,
    rotational: bool,
    parameters: Vec<Parameter>,
    /// Parameters that have bounds: name, value and bounds as they are written.
    bounded: Vec<(String, f64, Spanned<[f64; 2]>)>,
    nodes: Vec<Node>,
    /// Names of places, and their lines.
    places: Vec<(String, usize)>,
    /// Of the spring that stands in for a gear's mesh where an effect needs its twist, N m/rad (N/m): as good as rigid beside all else.
    contact_stiffness: f64,
}

impl Reader<'_> {
    fn fail<T, S>(&self, at: &Spanned<S>, message: impl Into<String>) -> Result<T, ModelError> {
        self.fail_in(line_of(self.text, at.span().start), message)
    }

    fn fail_in<T>(&self, line: usize, message: impl Into<String>) -> Result<T, ModelError> {
        Err(ModelError::File { line, message: message.into() })
    }

    fn model(mut self, raw: RawModel) -> Result<Model, ModelError> {
        if raw.schema.get_ref() != SCHEMA {
            return self.fail(
                &raw.schema,
                format!("schema is \"{}\", but this version reads \"{SCHEMA}\"", raw.schema.get_ref()),
            );
        }
        for (name, parameter) in raw.parameters.0 {
            let parameter = self.read_parameter(&name, parameter)?;
            self.parameters.push(parameter);
        }
        for node in raw.nodes.0 {
            self.declare(&node.name)?;
            let inertia = node.inertia.map(|name| self.positive(&name, Kind::Inertia)).transpose()?;
            self.nodes.push(Node { name: node.name.into_inner(), inertia });
        }
        let springs = self.each(raw.springs, Self::spring)?;
        let gears = self.each(raw.gears, Self::gear)?;
        let shafts = self.each(raw.shafts, Self::shaft)?;
        let bearings = self.each(raw.bearings, Self::bearing)?;
        let servo = raw.servo.map(|servo| self.servo(servo)).transpose()?;
        let channels = raw.channels.0.into_iter();
        let channels = channels.map(|(name, c)| self.channel(name, c)).collect::<Result<Vec<_>, _>>()?;
        for (role, what) in [(Role::Input, "input"), (Role::Output, "output")] {
            if !channels.iter().any(|channel| channel.role == role) {
                let line = line_of(self.text, self.text.find("[channels").unwrap_or(0));
                return self.fail_in(
                    line,
                    format!("[channels] has no {what}; give at least one channel role = \"{what}\""),
                );
            }
        }
        let mut model = Model {
            text: self.text.into(),
            name: raw.name,
            description: raw.description,
            motion: raw.motion,
            parameters: Vec::new(),
            nodes: Vec::new(),
            springs,
            gears,
            shafts,
            bearings,
            effects: Vec::new(),
            servo,
            channels,
        };
        std::mem::swap(&mut model.nodes, &mut self.nodes);
        self.contact_stiffness = self.rigid_stiffness(&model);
        for effect in raw.effects.0 {
            self.effect(effect, &mut model)?;
        }
        self.check_bounds()?;
        self.check_wiring(&model)?;
        model.parameters = self.parameters;
        add_clocks(&mut model);
        Ok(model)
    }

    fn each<R, T>(
        &mut self,
        raw: List<R>,
        f: impl Fn(&mut Self, R) -> Result<T, ModelError>,
    ) -> Result<Vec<T>, ModelError> {
        raw.0.into_iter().map(|item| f(self, item)).collect()
    }

    fn read_parameter(&mut self, name: &Name, raw: RawParameter) -> Result<Parameter, ModelError> {
        let label = name.get_ref();
        let Some(unit) = units::parse(raw.unit.get_ref()) else {
            return self.fail(&raw.unit, format!(
                "parameters.{label}.unit: \"{}\" is no unit; expected something like \"N m/rad\", \"kg m2\" or \"1\"",
                raw.unit.get_ref(),
            ));
        };
        if !raw.value.get_ref().is_finite() {
            return self.fail(&raw.value, format!("parameters.{label}.value must be a finite number"));
        }
        let [low, high] =
            raw.bounds.as_ref().map_or([f64::NEG_INFINITY, f64::INFINITY], |bounds| *bounds.get_ref());
        let bounds = (low * unit.factor, high * unit.factor);
        self.bounded.extend(raw.bounds.map(|bounds| (label.clone(), *raw.value.get_ref(), bounds)));
        let prior = raw.prior.map(|prior| match *prior.std.get_ref() {
            std if std > 0.0 && std.is_finite() && prior.value.is_finite() => {
                Ok(Prior { value: prior.value * unit.factor, std: std * unit.factor })
            }
            _ => self.fail(
                &prior.std,
                format!("parameters.{label}.prior needs a finite value and a positive std"),
            ),
        });
        Ok(Parameter {
            value: raw.value.get_ref() * unit.factor,
            name: label.clone(),
            unit: si_name(unit.dimension, raw.unit.get_ref()),
            file_unit: raw.unit.into_inner(),
            file_factor: unit.factor,
            bounds,
            fixed: raw.fixed,
            source: raw.source,
            prior: prior.transpose()?,
        })
    }

    /// Once it is known what parameters are: that an inertia is zero says more than that its bounds exclude it.
    fn check_bounds(&self) -> Result<(), ModelError> {
        for (name, value, bounds) in &self.bounded {
            let [low, high] = *bounds.get_ref();
            if low.partial_cmp(&high) != Some(std::cmp::Ordering::Less) {
                return self
                    .fail(bounds, format!("parameters.{name}.bounds must be [low, high] with low < high"));
            }
            if !(low..=high).contains(value) {
                return self.fail(
                    bounds,
                    format!(
                        "parameters.{name}.value is {value}, outside its bounds {low} to {high}; change either"
                    ),
                );
            }
        }
        Ok(())
    }

    fn declare(&mut self, name: &Name) -> Result<(), ModelError> {
        let label = name.get_ref();
        if let Some((_, line)) = self.places.iter().find(|(known, _)| known == label) {
            return self.fail(
                name,
                format!("the place \"{label}\" is there already, in line {line}; names must differ"),
            );
        }
        self.places.push((label.clone(), line_of(self.text, name.span().start)));
        Ok(())
    }

    fn node(&self, name: &Name) -> Result<usize, ModelError> {
        match self.nodes.iter().position(|node| node.name == *name.get_ref()) {
            Some(index) => Ok(index),
            None => {
                let known: Vec<_> = self.nodes.iter().map(|node| node.name.as_str()).collect();
                self.fail(
                    name,
                    format!("there is no node \"{}\"; nodes are {}", name.get_ref(), known.join(", ")),
                )
            }
        }
    }

    /// The name of the parameter that `key` refers to.
    fn name_of<'r>(&self, key: &str, reference: &'r Reference, kind: Kind) -> Result<&'r str, ModelError> {
        let value = match reference.get_ref() {
            Written::Name(name) => return Ok(name),
            Written::Number(number) => number.to_string(),
            Written::Other => "...".into(),
        };
        let letter = match kind {
            Kind::Inertia if self.rotational => "J",
            Kind::Inertia => "m",
            Kind::Stiffness => "k",
            Kind::Damping => "c",
            Kind::Ratio => "N",
            _ => "p",
        };
        let is_free = |name: &String| !self.parameters.iter().any(|parameter| parameter.name == *name);
        let name = (1..).map(|number| format!("{letter}{number}")).find(is_free).unwrap_or_default();
        let unit = kind.unit(self.rotational);
        let unit = if unit.is_empty() { "1" } else { unit };
        self.fail(
            reference,
            format!(
                "{key} must be the name of a parameter; write {key} = \"{name}\", and under [parameters] {name} = {{ value = {value}, unit = \"{unit}\" }}"
            ),
        )
    }

    /// Looks a parameter up where a quantity of `kind` is expected, and settles its unit.
    fn parameter(&mut self, key: &str, reference: &Reference, kind: Kind) -> Result<usize, ModelError> {
        let label = self.name_of(key, reference, kind)?;
        let Some(index) = self.parameters.iter().position(|parameter| parameter.name == *label) else {
            let unit = kind.unit(self.rotational);
            let unit = if unit.is_empty() { "1" } else { unit };
            return self.fail(
                reference,
                format!(
                    "there is no parameter \"{label}\"; declare it under [parameters], as in {label} = {{ value = 1, unit = \"{unit}\" }}"
                ),
            );
        };
        let Some(expected) = kind.dimension(self.rotational) else { return Ok(index) };
        let found = units::parse(&self.parameters[index].file_unit).map(|unit| unit.dimension);
        if found != Some(expected) {
            let unit = kind.unit(self.rotational);
            let message = format!(
                "{key} is parameter \"{label}\" in \"{}\", but here a unit like \"{unit}\" is expected",
                self.parameters[index].file_unit,
            );
            return self.fail(reference, message);
        }
        self.parameters[index].unit = kind.unit(self.rotational).into();
        Ok(index)
    }

    /// A parameter that cannot be negative; its lower bound is raised to zero where the file gives none.
    fn positive(&mut self, reference: &Reference, kind: Kind) -> Result<usize, ModelError> {
        let key = kind_name(kind);
        let index = self.parameter(key, reference, kind)?;
        let parameter = &mut self.parameters[index];
        parameter.bounds.0 = parameter.bounds.0.max(0.0);
        let (allowed, instead) = match kind {
            Kind::Inertia => ("positive", "; a node without inertia has no key inertia"),
            Kind::Stiffness => ("positive", "; where nothing joins the two nodes, leave the spring out"),
            _ => ("zero or more", ""),
        };
        if parameter.value < 0.0 || (parameter.value == 0.0 && kind != Kind::Damping) {
            let value = parameter.value / parameter.file_factor;
            let message = format!(
                "{key} \"{}\" is {value} {}, but it must be {allowed}{instead}",
                parameter.name, parameter.file_unit
            );
            return self.fail(reference, message);
        }
        Ok(index)
    }

    fn spring(&mut self, raw: RawSpring) -> Result<Spring, ModelError> {
        self.declare(&raw.name)?;
        let to = if raw.to.get_ref() == "ground" { None } else { Some(self.node(&raw.to)?) };
        let from = self.node(&raw.from)?;
        if to == Some(from) {
            return self.fail(&raw.to, "a spring must join two different nodes");
        }
        Ok(Spring {
            name: raw.name.into_inner(),
            from,
            to,
            stiffness: self.positive(&raw.stiffness, Kind::Stiffness)?,
            damping: raw.damping.map(|name| self.positive(&name, Kind::Damping)).transpose()?,
        })
    }

    fn gear(&mut self, raw: RawGear) -> Result<Gear, ModelError> {
        self.declare(&raw.name)?;
        let ratio = self.parameter("ratio", &raw.ratio, Kind::Ratio)?;
        if self.parameters[ratio].value == 0.0 {
            return self.fail(&raw.ratio, "a gear's ratio cannot be zero");
        }
        Ok(Gear { from: self.node(&raw.from)?, to: self.node(&raw.to)?, ratio, name: raw.name.into_inner() })
    }

    fn shaft(&mut self, raw: RawShaft) -> Result<Shaft, ModelError> {
        self.declare(&raw.name)?;
        Ok(Shaft { nodes: (self.node(&raw.from)?, self.node(&raw.to)?), name: raw.name.into_inner() })
    }

    fn bearing(&mut self, raw: RawBearing) -> Result<Bearing, ModelError> {
        self.declare(&raw.name)?;
        let damping = raw.damping.map(|name| self.positive(&name, Kind::Damping)).transpose()?;
        Ok(Bearing { node: self.node(&raw.at)?, damping, name: raw.name.into_inner() })
    }

    fn servo(&mut self, raw: RawServo) -> Result<Servo, ModelError> {
        self.declare(&raw.name)?;
        Ok(Servo {
            node: self.node(&raw.at)?,
            position_gain: self.parameter("position_gain", &raw.position_gain, Kind::Gain)?,
            velocity_gain: self.parameter("velocity_gain", &raw.velocity_gain, Kind::Gain)?,
            drive_gain: self.parameter("drive_gain", &raw.drive_gain, Kind::Gain)?,
            name: raw.name.into_inner(),
        })
    }

    fn effect(&mut self, raw: RawEffect, model: &mut Model) -> Result<(), ModelError> {
        let id = raw.effect.get_ref();
        let given = raw.parameters.0.iter().map(|(name, _)| name.get_ref().as_str());
        let acts_there = |effect: &Effect| model.places(effect).contains(&raw.at.get_ref().as_str());
        let Some(effect) = effects::find_at(id, given, acts_there) else {
            let known: Vec<_> = effects::CATALOGUE.iter().map(|effect| effect.id).collect();
            return self
                .fail(&raw.effect, format!("there is no effect \"{id}\"; effects are {}", known.join(", ")));
        };
        let place = raw.at.get_ref().clone();
        if !model.places(effect).contains(&place.as_str()) {
            let (what, places) = (effect.acts_at.noun(), model.places(effect).join(", "));
            return self
                .fail(&raw.at, format!("{id} acts at {what}, and \"{place}\" is none; there is {places}"));
        }
        let known = |name: &str| effect.parameters.iter().any(|parameter| parameter.name == name);
        if let Some((name, _)) = raw.parameters.0.iter().find(|(name, _)| !known(name.get_ref())) {
            let names = effects::parameters_of(id).join(", ");
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
                    return self
                        .fail(&raw.effect, format!("{id} needs the parameter \"{}\"", parameter.name));
                }
            });
        }
        if !self.put(effect, place, indices, model) {
            return self.fail(&raw.at, format!("{id} cannot act at \"{}\"", raw.at.get_ref()));
        }
        Ok(())
    }

    /// Stiffness that is as good as rigid, by the file's springs and inertias.
    fn rigid_stiffness(&self, model: &Model) -> f64 {
        let value = |parameter: usize| self.parameters[parameter].value;
        let springs = model.springs.iter().filter(|spring| effects::is_part(&spring.name));
        let inertias = model.nodes.iter().filter_map(|node| node.inertia);
        effects::rigid_stiffness(springs.map(|spring| value(spring.stiffness)), inertias.map(value))
    }

    /// Puts an effect with its own parameters where it acts; whether that is a place for it.
    fn put(&mut self, effect: &'static Effect, place: String, own: Vec<usize>, model: &mut Model) -> bool {
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
                _ => {
                    let bearing = model.bearings.iter().find(|bearing| bearing.name == place);
                    indices.extend(bearing.and_then(|bearing| bearing.damping));
                }
            }
        }
        model.effects.push(EffectUse { effect, place, at, parameters: indices });
        true
    }

    /// A parameter of an effect; its bounds are narrowed to what makes sense for it.
    fn effect_parameter(
        &mut self,
        name: &Reference,
        own: &effects::EffectParameter,
    ) -> Result<usize, ModelError> {
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

    /// Where an effect acts; changes the network where it must.
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
                // How a knock rebounds is the play's to say.
                if let Some(own_damping) = effect.parameters.iter().position(|p| p.name == CONTACT_DAMPING) {
                    model.springs[contact].damping = Some(own[own_damping]);
                }
                let slow = model.springs[contact].to?;
                Some(Site::Gear { fast, slow, contact })
            }
        }
    }

    /// Puts a stiff spring behind a gear, once.
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
        let mut own = |name: &'static str, kind: Kind, value: f64| {
            let parameter =
                effects::EffectParameter { name, kind, default: None, bounds: (0.0, f64::INFINITY) };
            self.default_of(&place, &parameter, (value, value))
        };
        let stiffness = own("contact_stiffness", Kind::Stiffness, contact_stiffness);
        let damping = Some(own(CONTACT_DAMPING, Kind::Damping, CONTACT_RELAXATION_S * contact_stiffness));
        let from = model.nodes.len() - 1;
        model.springs.push(Spring { name, from, to: Some(slow), stiffness, damping });
        model.springs.len() - 1
    }

    /// A numerical constant of a law that the file leaves to us. What two effects at one place leave to us under one name is one number.
    fn default_of(
        &mut self,
        place: &str,
        parameter: &effects::EffectParameter,
        default: (f64, f64),
    ) -> usize {
        let name = format!("{place}.{}", parameter.name);
        let known = self.parameters.iter().position(|known| known.name == name);
        known.unwrap_or_else(|| self.add_default(place, parameter, default))
    }

    /// A parameter that no file names.
    fn add_default(
        &mut self,
        place: &str,
        parameter: &effects::EffectParameter,
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

/// Inputs that only tell laws the time, or how far a shaft has turned, where some law asks.
fn add_clocks(model: &mut Model) {
    let asks = |law_input: LawInput| model.effects.iter().any(|used| used.effect.sees(law_input));
    let tachometer = |role: Role| {
        let is_one = |c: &&Channel| {
            c.role == role && c.quantity == Quantity::Speed && matches!(c.take, Take::Value | Take::Rate)
        };
        model.channels.iter().find(is_one)
    };
    let clock = |like: &Channel, name: &str, quantity: Quantity, take: Take| Channel {
        name: name.into(),
        column: like.column.clone(),
        role: Role::Input,
        quantity,
        at: like.at.clone(),
        take,
        scale: if quantity == Quantity::Time { 1.0 } else { like.scale },
        offset: 0.0,
        gain: None,
        noise_std: None,
        estimate_offset: false,
        between: None,
        unit: match quantity {
            Quantity::Time => "s",
            Quantity::Change => "1/s",
            _ => "rad",
        },
    };
    let mut clocks = Vec::new();
    if asks(LawInput::Time)
        && let Some(input) = model.channels.iter().find(|channel| channel.role == Role::Input)
    {
        clocks.push(clock(input, "time", Quantity::Time, Take::Elapsed));
    }
    if asks(LawInput::Angle)
        && let Some(tachometer) = tachometer(Role::Input).or_else(|| tachometer(Role::Output))
    {
        // The rate of an encoder's angle: then the angle itself is there, and counts on from one recording to the next.
        let take = if tachometer.take == Take::Rate { Take::Value } else { Take::Turned };
        clocks.push(clock(tachometer, "turned", Quantity::Turned, take));
    }
    for used in model.effects.iter().filter(|used| used.effect.sees(LawInput::Change)) {
        let Site::Channel(channel) = used.at else { continue };
        let own = &model.channels[channel];
        let changes = clock(own, &change_of(&own.name), Quantity::Change, Take::Rate);
        if !clocks.contains(&changes) {
            clocks.push(changes);
        }
    }
    model.channels.extend(clocks);
}

/// Name of the input that says how fast another one changes.
pub(crate) fn change_of(channel: &str) -> String {
    format!("{channel} changes")
}

fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Inertia => "inertia",
        Kind::Stiffness => "stiffness",
        _ => "damping",
    }
}

/// SI name of a parameter that no element has claimed: its own unit where that is SI already.
fn si_name(dimension: units::Dimension, file_unit: &str) -> String {
    match units::parse(file_unit) {
        Some(unit) if unit.factor == 1.0 => file_unit.into(),
        _ => {
            let names = ["kg", "m", "s", "A", "V"];
            let factors = names.iter().zip(dimension).filter(|(_, power)| *power != 0);
            let text: Vec<_> = factors.map(|(name, power)| format!("{name}^{power}")).collect();
            if text.is_empty() { "1".into() } else { text.join(" ") }
        }
    }
}
