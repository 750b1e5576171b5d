//! Laws of effects, true values of inputs, and readings of outputs.

use socam_model::{
    Quantity, Site,
    effects::{Acts, Form, Law, LawInput},
};

use super::{
    Output, State,
    builder::{Builder, minus, name, over, plus, sum, times},
};
use crate::{error::ExportError, formula::Formula};

/// The channel that an input of a law is.
fn channel_of(law: &Law, symbol: &str) -> Option<&'static str> {
    law.law_inputs.iter().find_map(|input| match input {
        LawInput::Channel { channel, symbol: own } if *own == symbol => Some(*channel),
        _ => None,
    })
}

type Bound<'n> = [(&'n str, Formula)];

impl Builder<'_, '_> {
    /// The formula of a law with the model's parameters and the given inputs.
    pub(crate) fn law(&self, used: usize, law: &Law, bound: &Bound<'_>) -> Result<Formula, ExportError> {
        let own = &self.d.model.effects[used];
        let missing =
            || ExportError::NoFormula { effect: own.effect.id.to_owned(), place: own.place.clone() };
        let formula = Formula::parse(law.formula).map_err(|_| missing())?;
        let borrowed = own.effect.borrows.map_or(&[][..], |borrowed| borrowed.symbols());
        let names: Vec<&str> =
            own.effect.parameters.iter().map(|own| own.name).chain(borrowed.iter().copied()).collect();
        let by = |symbol: &str| {
            if let Some((_, formula)) = bound.iter().find(|(known, _)| *known == symbol) {
                return Some(formula.clone());
            }
            if let Some(channel) = channel_of(law, symbol) {
                return self.true_channel(channel, own.at);
            }
            if symbol == "time" {
                return Some(name("t"));
            }
            if symbol == "state" {
                return self.own_states[used].first().map(|state| name(state));
            }
            let index = names.iter().position(|known| *known == symbol)?;
            own.parameters.get(index).map(|parameter| self.parameter(*parameter))
        };
        if formula.names(&|symbol| symbol != "pi" && by(symbol).is_none()) {
            return Err(missing());
        }
        Ok(formula.replaced(&by))
    }

    /// What a law at `site` sees of a channel: the true value of an input, what the model predicts of an output. `None` where that is not known
    /// yet: a torque within the laws of springs, an acceleration.
    fn true_channel(&self, channel: &str, site: Site) -> Option<Formula> {
        if let Some(signal) = self.d.inputs.iter().find(|signal| signal.channel.name == channel) {
            let mut beside =
                self.d.model.effects.iter().filter(|used| used.at == Site::Channel(signal.index));
            return beside.next().is_none().then(|| self.gained(signal));
        }
        let output = self.d.outputs.iter().find(|signal| signal.channel.name == channel)?.channel;
        let at_spring = matches!(site, Site::Spring(_) | Site::Gear { .. });
        match output.quantity {
            Quantity::Speed | Quantity::Angle => Some(self.measured(output.quantity, &output.at)),
            Quantity::Torque if !at_spring => Some(self.measured(output.quantity, &output.at)),
            _ => None,
        }
    }

    /// The responses of an effect's laws that act so.
    pub(crate) fn laws_of(
        &self,
        used: usize,
        acts: Acts,
        bound: &Bound<'_>,
    ) -> Result<Vec<Formula>, ExportError> {
        let laws = self.d.model.effects[used].effect.laws().iter().filter(|law| law.acts == acts);
        laws.map(|law| self.law(used, law, bound)).collect()
    }

    /// Adds the states of an effect.
    pub(crate) fn state_laws(&mut self, used: usize, bound: &Bound<'_>) -> Result<(), ExportError> {
        let rates = self.laws_of(used, Acts::State, bound)?;
        let own = &self.d.model.effects[used];
        let meaning = format!("state of {} at {}", own.effect.id, own.place);
        for (rate, name) in rates.into_iter().zip(self.own_states[used].clone()) {
            self.states.push(State { name, meaning: meaning.clone(), rate });
        }
        Ok(())
    }

    /// Formulas that the laws at a channel add to its reading.
    fn beside(&self, channel: usize, bound: &Bound<'_>) -> Result<Vec<Formula>, ExportError> {
        let own =
            self.d.model.effects.iter().enumerate().filter(|(_, used)| used.at == Site::Channel(channel));
        let laws = own.map(|(used, _)| self.laws_of(used, Acts::Reading, bound));
        Ok(laws.collect::<Result<Vec<_>, _>>()?.concat())
    }

    /// True value of an input: its gain times the recorded value, minus what laws at its channel add to the reading.
    pub(crate) fn true_input(
        &mut self,
        input: usize,
        angle: Option<Formula>,
    ) -> Result<Formula, ExportError> {
        let signal = &self.d.inputs[input];
        let (read, index, channel) = (name(&signal.identifier), signal.index, signal.channel);
        let gain = self.d.gain(signal);
        let mut bound = vec![("reading", read.clone())];
        bound.extend(angle.map(|angle| ("angle", angle)));
        let effects = self.d.model.effects.iter();
        let changes = effects.filter(|used| used.at == Site::Channel(index)).any(|used| {
            used.effect
                .laws()
                .iter()
                .any(|law| law.formula.split(|c: char| !c.is_alphanumeric()).any(|word| word == "change"))
        });
        if changes {
            let derivative = self.d.names.unique(&format!("change_{}", channel.name));
            bound.push(("change", name(&derivative)));
            self.changes.push((input, derivative));
        }
        let added = self.beside(index, &bound)?;
        let truth = added.into_iter().fold(read, minus);
        Ok(gain.map_or(truth.clone(), |gain| times(gain, truth)))
    }

    /// Readings of all outputs.
    pub(crate) fn outputs(&mut self) -> Result<Vec<Output>, ExportError> {
        self.comment("readings");
        (0..self.d.outputs.len()).map(|output| self.output(output)).collect()
    }

    fn output(&mut self, output: usize) -> Result<Output, ExportError> {
        let signal = &self.d.outputs[output];
        let (channel, index, identifier) = (signal.channel, signal.index, signal.identifier.clone());
        let measured = self.measured(channel.quantity, &channel.at);
        let gain = self.d.gain(signal);
        let truth = self.d.names.unique(&format!("true_{}", channel.name));
        self.assign(&truth, gain.map_or(measured.clone(), |gain| times(gain, measured)));
        let mut bound = vec![("reading", name(&truth))];
        // A channel without a shaft, such as the servo's torque, has no angle.
        let shaft = self.d.shaft_of(channel).map(|node| name(&self.d.points[node].angle));
        bound.push(("angle", shaft.unwrap_or(Formula::Number(0.0))));
        let (filtered, delay) = self.filtered(index, &truth);
        let added = self.beside(index, &bound)?;
        self.assign(&identifier, added.into_iter().fold(filtered, plus));
        Ok(Output { reading: name(&identifier), delay })
    }

    fn measured(&self, quantity: Quantity, at: &str) -> Formula {
        let node = self.d.node(at);
        match (quantity, node) {
            (Quantity::Speed, Some(node)) => name(&self.d.points[node].speed),
            (Quantity::Angle, Some(node)) => name(&self.d.points[node].angle),
            (Quantity::Acceleration, Some(node)) => self.acceleration(node),
            // The servo's torque stands behind those of the springs.
            _ => match self.d.spring(at).or(self.through.len().checked_sub(1)) {
                Some(spring) => name(&self.through[spring]),
                None => sum(Vec::new()),
            },
        }
    }

    /// The reading behind a lag, and the parameter of a delay.
    fn filtered(&mut self, channel: usize, truth: &str) -> (Formula, Option<usize>) {
        let (mut reading, mut delay) = (name(truth), None);
        for used in 0..self.d.model.effects.len() {
            let own = &self.d.model.effects[used];
            if own.at != Site::Channel(channel) {
                continue;
            }
            match own.effect.form {
                Form::Lag => {
                    let (time_constant, place) = (self.parameter(own.parameters[0]), own.place.clone());
                    let state = self.d.names.unique(&format!("late_{place}"));
                    let rate = over(minus(reading, name(&state)), time_constant);
                    let meaning = format!("reading of {place} behind its lag");
                    self.states.push(State { name: state.clone(), meaning, rate });
                    reading = name(&state);
                }
                Form::Delay => delay = Some(own.parameters[0]),
                Form::Laws(_) | Form::Inertia | Form::Compliance | Form::Mounting | Form::Gain => {}
            }
        }
        (reading, delay)
    }
}
