//! Description that all targets read: the model with identifiers, intervals, and the coordinates that rigid gears and shafts leave.

use socam_model::{Channel, Model, Quantity, Role, Site, effects::Form};

use crate::{Provenance, formula::Formula, names::Names};

mod coordinates;

pub(crate) use coordinates::{Coordinate, CoordinateMotion, Lever};

/// A parameter with its value and interval.
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) identifier: String,
    /// SI.
    pub(crate) value: f64,
    pub(crate) unit: String,
    /// 95 % interval of the model file, SI.
    pub(crate) ci95: Option<[f64; 2]>,
    pub(crate) source: String,
    pub(crate) fixed: bool,
    pub(crate) bounds: (f64, f64),
}

/// A node: its identifiers, its coordinate, and its motion divided by that of the coordinate.
pub(crate) struct Point {
    pub(crate) name: String,
    pub(crate) identifier: String,
    pub(crate) angle: String,
    pub(crate) speed: String,
    /// Identifiers of the node's joint and of its tendon.
    pub(crate) joint: String,
    pub(crate) tendon: String,
    pub(crate) coordinate: usize,
    pub(crate) lever: Lever,
    /// Parameters whose sum is the inertia of the node.
    pub(crate) inertias: Vec<usize>,
}

/// A channel with its identifier; clocks are not included.
pub(crate) struct Signal<'m> {
    pub(crate) channel: &'m Channel,
    /// Index in [`Model::channels`].
    pub(crate) index: usize,
    pub(crate) identifier: String,
}

pub(crate) struct Description<'m> {
    pub(crate) model: &'m Model,
    pub(crate) provenance: &'m Provenance,
    pub(crate) identifier: String,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) points: Vec<Point>,
    pub(crate) coordinates: Vec<Coordinate>,
    /// Identifiers of springs, gears and bearings.
    pub(crate) springs: Vec<String>,
    pub(crate) gears: Vec<String>,
    pub(crate) bearings: Vec<String>,
    pub(crate) inputs: Vec<Signal<'m>>,
    pub(crate) outputs: Vec<Signal<'m>>,
    /// Identifiers of effects, place and effect.
    pub(crate) effects: Vec<String>,
    pub(crate) names: Names,
}

impl<'m> Description<'m> {
    pub(crate) fn of(model: &'m Model, provenance: &'m Provenance, name: &str) -> Self {
        let mut names = Names::new();
        let identifier = names.unique(name);
        let intervals = intervals(model);
        let parameters = model.parameters.iter().zip(intervals);
        let parameters = parameters.map(|(own, ci95)| Parameter {
            name: own.name.clone(),
            identifier: names.unique(&own.name),
            value: own.value,
            unit: own.unit.clone(),
            ci95,
            source: own.source.clone(),
            fixed: own.fixed,
            bounds: own.bounds,
        });
        let parameters = parameters.collect();
        let (coordinates, of_nodes) = coordinates::of(model);
        let mut points = Vec::new();
        for ((index, node), (coordinate, lever)) in model.nodes.iter().enumerate().zip(of_nodes) {
            let added = model
                .effects
                .iter()
                .filter(|used| matches!(used.effect.form, Form::Inertia) && used.at == Site::Node(index));
            points.push(Point {
                name: node.name.clone(),
                identifier: names.unique(&node.name),
                angle: names.unique(&format!("angle_{}", node.name)),
                speed: names.unique(&format!("speed_{}", node.name)),
                joint: names.unique(&format!("q_{}", node.name)),
                tendon: names.unique(&format!("node_{}", node.name)),
                coordinate,
                lever,
                inertias: node.inertia.into_iter().chain(added.map(|used| used.parameters[0])).collect(),
            });
        }
        let mut each = |all: &mut dyn Iterator<Item = &String>| -> Vec<String> {
            all.map(|name| names.unique(name)).collect()
        };
        let springs = each(&mut model.springs.iter().map(|spring| &spring.name));
        let gears = each(&mut model.gears.iter().map(|gear| &gear.name));
        let bearings = each(&mut model.bearings.iter().map(|bearing| &bearing.name));
        let mut signals = |role: Role, prefix: &str| -> Vec<Signal<'m>> {
            let own = model.channels.iter().enumerate();
            let own = own.filter(|(_, c)| c.role == role && !c.quantity.is_clock());
            let signal = |(index, channel): (usize, &'m Channel)| Signal {
                channel,
                index,
                identifier: names.unique(&format!("{prefix}_{}", channel.name)),
            };
            own.map(signal).collect()
        };
        let (inputs, outputs) = (signals(Role::Input, "input"), signals(Role::Output, "reading"));
        let effects = model.effects.iter();
        let effects =
            effects.map(|used| names.unique(&format!("{}_{}", used.place, used.effect.id))).collect();
        Self {
            model,
            provenance,
            identifier,
            parameters,
            points,
            coordinates,
            springs,
            gears,
            bearings,
            inputs,
            outputs,
            effects,
            names,
        }
    }

    /// Value of a parameter, SI.
    pub(crate) fn value(&self, parameter: usize) -> f64 {
        self.parameters[parameter].value
    }

    /// Index of a node by its name.
    pub(crate) fn node(&self, name: &str) -> Option<usize> {
        self.model.nodes.iter().position(|node| node.name == name)
    }

    /// Index of a spring by its name.
    pub(crate) fn spring(&self, name: &str) -> Option<usize> {
        self.model.springs.iter().position(|spring| spring.name == name)
    }

    /// The spring whose twist an input adds to.
    pub(crate) fn twisted(&self, signal: &Signal<'_>) -> Option<usize> {
        let twists = signal.channel.role == Role::Input && signal.channel.quantity == Quantity::Angle;
        self.spring(&signal.channel.at).filter(|_| twists)
    }

    /// The node of a channel's sensor: the channel's node, or the driving end of its spring.
    pub(crate) fn shaft_of(&self, channel: &Channel) -> Option<usize> {
        self.node(&channel.at)
            .or_else(|| self.spring(&channel.at).map(|spring| self.model.springs[spring].from))
    }

    /// Inertia of a coordinate, SI: those of its nodes, seen from it.
    pub(crate) fn inertia(&self, coordinate: usize) -> f64 {
        let own = self.points.iter().filter(|point| point.coordinate == coordinate);
        own.map(|point| {
            point.inertias.iter().map(|j| self.value(*j)).sum::<f64>() * point.lever.value.powi(2)
        })
        .sum()
    }

    /// Gain of a channel as a formula: for an input, the acting value divided by the recorded one; for an output, the reading
    /// divided by the true value.
    pub(crate) fn gain(&self, signal: &Signal<'_>) -> Option<Formula> {
        let name = |parameter: usize| Formula::Name(self.parameters[parameter].identifier.clone());
        let mut gain = signal.channel.gain.map(name);
        let own = self
            .model
            .effects
            .iter()
            .filter(|used| matches!(used.effect.form, Form::Gain) && used.place == signal.channel.name);
        for used in own {
            let operator = if signal.channel.role == Role::Input { '/' } else { '*' };
            let before = gain.unwrap_or(Formula::Number(1.0));
            gain = Some(Formula::Binary(operator, Box::new(before), Box::new(name(used.parameters[0]))));
        }
        gain
    }

    /// [`Self::gain`] as a number.
    pub(crate) fn gain_value(&self, signal: &Signal<'_>) -> f64 {
        let own = signal.channel.gain.map_or(1.0, |parameter| self.value(parameter));
        let effects = self
            .model
            .effects
            .iter()
            .filter(|used| matches!(used.effect.form, Form::Gain) && used.place == signal.channel.name);
        effects.fold(own, |gain, used| {
            let read = self.value(used.parameters[0]);
            if signal.channel.role == Role::Input { gain / read } else { gain * read }
        })
    }

    /// Units of a coordinate's torque and speed.
    pub(crate) fn is_rotation(&self) -> bool {
        self.model.motion == socam_model::Motion::Rotation
    }
}

/// `ci95` of each parameter, SI.
fn intervals(model: &Model) -> Vec<Option<[f64; 2]>> {
    let table: Option<toml::Table> = model.text.parse().ok();
    let parameters = table.as_ref().and_then(|table| table.get("parameters")?.as_table());
    let number = |value: &toml::Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
    let ends = |parameter: &socam_model::Parameter| {
        let ends = parameters?.get(&parameter.name)?.get("ci95")?.as_array()?;
        let end = |index: usize| Some(number(ends.get(index)?)? * parameter.file_factor);
        Some([end(0)?, end(1)?])
    };
    model.parameters.iter().map(ends).collect()
}
