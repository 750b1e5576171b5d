//! The ports and the states that an effect adds to the equations.

use crate::{
    EffectUse, Port,
    effects::{Acts, Form, Law, sensor_delay},
};

/// Number of states that an effect adds.
pub(super) fn states_of(used: &EffectUse) -> usize {
    match used.effect.form {
        Form::Laws(laws) => laws.iter().filter(|law| law.acts == Acts::State).count(),
        Form::Lag => 1,
        Form::Delay => 2 * sensor_delay::SECTIONS.len(),
        Form::Inertia | Form::Compliance | Form::Mounting | Form::Gain => 0,
    }
}

pub(super) fn ports_of(index: usize, used: &EffectUse) -> Vec<(Port, usize)> {
    let port = |law: &'static Law, law_input: usize| Port {
        effect: used.effect,
        law,
        place: used.place.clone(),
        parameters: used.parameters.clone(),
        law_input,
    };
    let law_inputs =
        used.effect.laws().iter().flat_map(|law| (0..law.law_inputs.len().max(1)).map(move |s| (law, s)));
    law_inputs.map(|(law, law_input)| (port(law, law_input), index)).collect()
}
