//! Reads model files: TOML in, a checked [`Model`] in SI out; each error has a line.

use crate::{
    Channel, EffectUse, Model, ModelError, Motion, Role, Site,
    effects::{Effect, QuantityKind, SERVO_LIMIT},
    model::Node,
};

use raw::RawModel;
use reader::Reader;
use wording::line_of;

mod channel;
mod clocks;
mod curves;
#[cfg(test)]
mod documented;
mod effects;
mod elements;
mod laws;
mod lists;
mod parameters;
mod raw;
mod reader;
#[cfg(test)]
mod tests;
mod wiring;
mod wording;

pub use channel::column_unit;
pub(crate) use clocks::change_of;

const SCHEMA: &str = "socam.model/1";

impl Model {
    /// Parses the text of a model file, checks it, and forms its equations once.
    ///
    /// ```
    /// use socam_model::Model;
    ///
    /// let text = r#"
    /// schema = "socam.model/1"
    /// name = "flywheel"
    /// motion = "rotation"
    /// [parameters]
    /// inertia = { value = 40, unit = "g m2" }
    /// drag = { value = 0.02, unit = "N m s/rad" }
    /// [[nodes]]
    /// name = "wheel"
    /// inertia = "inertia"
    /// [[bearings]]
    /// name = "hub"
    /// at = "wheel"
    /// damping = "drag"
    /// [channels.torque]
    /// role = "input"
    /// quantity = "torque"
    /// at = "wheel"
    /// [channels.speed]
    /// role = "output"
    /// quantity = "speed"
    /// at = "wheel"
    /// "#;
    /// let model = Model::parse(text)?;
    /// assert_eq!(model.parameters[0].value, 0.04);
    /// assert!(Model::parse(&text.replace("drag\"", "drog\"")).is_err());
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::File`] with the line, the key and what was expected there.
    pub fn parse(text: &str) -> Result<Self, ModelError> {
        let model = read(text)?;
        // A network without equations is refused here and not in a fit.
        model.equations(&model.values()).map_err(|error| placed(text, error))?;
        Ok(model)
    }

    /// The model with one more effect, whose parameters are fixed at `values` (SI), for simulated benches. The effect need not be in the
    /// catalogue. [`Self::text`] does not change, because a file can name effects of the catalogue only.
    ///
    /// ```
    /// use socam_model::{Model, effects};
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// let drag = effects::find("quadratic_drag").expect("an effect of the catalogue");
    /// let windy = model.with_law(drag, "load_bearing", &[1e-3])?;
    /// assert_eq!(windy.equations(&windy.values())?.ports.len(), 1);
    /// assert!(model.with_law(drag, "shaft", &[1e-3]).is_err());
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::Network`] where the effect cannot act at that place; otherwise as [`Self::equations`].
    pub fn with_law(&self, effect: &'static Effect, place: &str, values: &[f64]) -> Result<Self, ModelError> {
        let refused = || ModelError::Network(format!("{} cannot act at {place}", effect.id));
        let model = put(self, effect, place, values).ok_or_else(refused)?;
        model.equations(&model.values())?;
        Ok(model)
    }
}

fn read(text: &str) -> Result<Model, ModelError> {
    if let Some(line) = socam_toml::too_deep(text) {
        let message = format!("more than {} brackets are open here; close them", socam_toml::DEEPEST);
        return Err(ModelError::File { line, message });
    }
    let raw: RawModel = toml::from_str(text).map_err(|error| wording::explained(text, &error))?;
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

/// See [`Model::with_law`]; `None` where the effect cannot act at that place, or the number of values is wrong.
fn put(model: &Model, effect: &'static Effect, place: &str, values: &[f64]) -> Option<Model> {
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
    clocks::add_clocks(&mut model);
    fits.then_some(model)
}

/// An error of the network with the line of the file that declares the first name in its message; unchanged if no line does.
fn placed(text: &str, error: ModelError) -> ModelError {
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

impl Reader<'_> {
    fn model(mut self, raw: RawModel) -> Result<Model, ModelError> {
        if raw.schema.get_ref() != SCHEMA {
            return self.fail(
                &raw.schema,
                format!(
                    "schema is \"{}\", but this version reads \"{SCHEMA}\"; write schema = \"{SCHEMA}\"",
                    raw.schema.get_ref()
                ),
            );
        }
        for (name, parameter) in raw.parameters.0 {
            let parameter = self.read_parameter(&name, parameter)?;
            self.parameters.push(parameter);
        }
        for node in raw.nodes.0 {
            self.declare(&node.name)?;
            let inertia = node.inertia.map(|name| self.positive(&name, QuantityKind::Inertia)).transpose()?;
            self.nodes.push(Node { name: node.name.into_inner(), inertia });
        }
        let springs = self.each(raw.springs, Self::spring)?;
        let gears = self.each(raw.gears, Self::gear)?;
        let differentials = self.each(raw.differentials, Self::differential)?;
        let shafts = self.each(raw.shafts, Self::shaft)?;
        let bearings = self.each(raw.bearings, Self::bearing)?;
        let motors = self.each(raw.motors, Self::motor)?;
        let servo = raw.servo.map(|servo| self.servo(servo)).transpose()?;
        let channels = raw.channels.0.into_iter();
        let channels = channels.map(|(name, c)| self.channel(name, c)).collect::<Result<Vec<_>, _>>()?;
        self.check_roles(&channels)?;
        let mut model = Model {
            text: self.text.into(),
            name: raw.name,
            description: raw.description,
            motion: raw.motion,
            parameters: Vec::new(),
            nodes: Vec::new(),
            springs,
            gears,
            differentials,
            shafts,
            bearings,
            effects: Vec::new(),
            candidates: Vec::new(),
            motors,
            servo,
            channels,
        };
        std::mem::swap(&mut model.nodes, &mut self.nodes);
        model.effects.extend(model.servo.iter().filter_map(|servo| {
            let (effect, place) = (&SERVO_LIMIT, servo.name.clone());
            Some(EffectUse { effect, place, at: Site::Servo, parameters: vec![servo.limit?] })
        }));
        self.contact_stiffness = self.rigid_stiffness(&model);
        for law in raw.laws.0 {
            self.law(law, &mut model)?;
        }
        for effect in raw.effects.0 {
            self.effect(effect, &mut model)?;
        }
        self.check_bounds()?;
        self.check_wiring(&model)?;
        model.parameters = self.parameters;
        model.fix_candidates();
        clocks::add_clocks(&mut model);
        Ok(model)
    }

    /// Refuses a model without an output. One without an input swings freely from its start state.
    fn check_roles(&self, channels: &[Channel]) -> Result<(), ModelError> {
        if channels.iter().any(|channel| channel.role == Role::Output) {
            return Ok(());
        }
        let line = line_of(self.text, self.text.find("[channels").unwrap_or(0));
        self.fail_in(
            line,
            "[channels] has no output; write at least one channel with role = \"output\"".to_owned(),
        )
    }
}
