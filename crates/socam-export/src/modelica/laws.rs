//! Laws, inputs and readings as equations that drive sources.

use super::{
    Acts, Body, Builder, Description, ExportError, Formula, Library, Line, MODELICA, Quantity, State, quoted,
    written,
};

pub(super) fn declare(
    d: &mut Description<'_>,
    library: &Library,
    body: &mut Body,
) -> Result<(), ExportError> {
    let source = d.names.unique("source");
    let mut builder = Builder::new(d);
    builder.name_states();
    body.declarations.push("Real t \"time, s\"".into());
    body.equations.push("t = time".into());
    for index in 0..builder.d.inputs.len() {
        let signal = &builder.d.inputs[index];
        let words = quoted(&format!("{}, {}", signal.channel.name, signal.channel.unit));
        body.declarations.push(format!("Modelica.Blocks.Interfaces.RealInput {} {words}", signal.identifier));
    }
    springs(&mut builder, library, body)?;
    for used in 0..builder.d.model.effects.len() {
        let Some((node, acts, bound)) = builder.seen_at_node(used) else { continue };
        let (id, place) = (builder.d.model.effects[used].effect.id, &builder.d.model.effects[used].place);
        let words = format!("{id} at {place}");
        if acts == Acts::Torque {
            builder.state_laws(used, &bound)?;
        }
        for law in builder.laws_of(used, acts, &bound)? {
            let name = builder.d.names.unique(&builder.d.effects[used].clone());
            torque(library, body, &name, node, &law, &words);
        }
    }
    if let Some((node, formula)) = builder.servo() {
        let name =
            builder.d.names.unique(builder.d.model.servo.as_ref().map_or("servo", |servo| &servo.name));
        torque(library, body, &name, node, &formula, "servo");
        let through = builder.d.names.unique(&format!("torque_{name}"));
        body.declarations.push(format!("Real {through}"));
        body.equations.push(format!("{through} = {name}.{}", library.torque_value));
        builder.through.push(through);
    }
    inputs(&mut builder, library, body, &source)?;
    readings(&mut builder, body)
}

/// A source on a node, driven by a formula.
fn torque(library: &Library, body: &mut Body, name: &str, node: usize, formula: &Formula, words: &str) {
    let (package, kind, value) = (library.package, library.torque, library.torque_value);
    body.declarations.push(format!("{package}.Sources.{kind} {name} {}", quoted(words)));
    body.tie(node, format!("{name}.flange"));
    body.equations.push(format!("{name}.{value} = {}", formula.written(&MODELICA)));
}

/// Torques that laws and angle inputs add to those of springs, and the torque through each spring.
fn springs(builder: &mut Builder<'_, '_>, library: &Library, body: &mut Body) -> Result<(), ExportError> {
    let (package, kind, value) = (library.package, library.torque, library.torque_value);
    for index in 0..builder.d.model.springs.len() {
        let (spring, own) = (&builder.d.model.springs[index], builder.d.springs[index].clone());
        let (from, to) = (spring.from, spring.to);
        let mut added = Vec::new();
        for signal in builder.d.inputs.iter().filter(|signal| builder.d.twisted(signal) == Some(index)) {
            let stiffness = Box::new(builder.parameter(spring.stiffness));
            added.push(Formula::Binary('*', stiffness, Box::new(builder.gained(signal))));
        }
        for used in builder.effects_at(index) {
            let bound = builder.seen_at_spring(used, index);
            added.extend(builder.laws_of(used, Acts::Torque, &bound)?);
            builder.state_laws(used, &bound)?;
        }
        let mut sum = format!("{own}.flange_a.{value}");
        for law in added {
            let name = builder.d.names.unique(&format!("{own}_law"));
            body.declarations.push(format!("{package}.Sources.{kind}2 {name}"));
            body.equations.push(format!("{name}.{value} = {}", law.written(&MODELICA)));
            body.tie(from, format!("{name}.flange_a"));
            match to {
                Some(to) => body.tie(to, format!("{name}.flange_b")),
                None => body.equations.push(format!("connect({name}.flange_b, {own}_ground.flange)")),
            }
            sum.push_str(&format!(" + {name}.{value}"));
        }
        let through = builder.through[index].clone();
        let words = quoted(&format!("torque through {}", builder.d.model.springs[index].name));
        body.declarations.push(format!("Real {through} {words}"));
        body.equations.push(format!("{through} = {sum}"));
    }
    Ok(())
}

/// Torques and speeds that inputs apply.
fn inputs(
    builder: &mut Builder<'_, '_>,
    library: &Library,
    body: &mut Body,
    source: &str,
) -> Result<(), ExportError> {
    for index in 0..builder.d.inputs.len() {
        let channel = builder.d.inputs[index].channel;
        let Some(node) = builder.d.node(&channel.at) else { continue };
        let angle = Formula::Name(builder.d.points[node].angle.clone());
        let formula = builder.true_input(index, Some(angle))?;
        for (input, change) in std::mem::take(&mut builder.changes) {
            body.declarations.push(format!("Real {change}"));
            body.equations.push(format!("{change} = der({})", builder.d.inputs[input].identifier));
        }
        let name = builder.d.names.unique(&format!("{source}_{}", channel.name));
        match channel.quantity {
            Quantity::Torque => torque(library, body, &name, node, &formula, &channel.name),
            Quantity::Speed => {
                let (package, reference) =
                    (library.package, if library.angle == "phi" { "w_ref" } else { "v_ref" });
                body.declarations.push(format!("{package}.Sources.Speed {name}(exact=true)"));
                body.tie(node, format!("{name}.flange"));
                body.equations.push(format!("{name}.{reference} = {}", formula.written(&MODELICA)));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Readings of sensors, and the states of laws and filters.
fn readings(builder: &mut Builder<'_, '_>, body: &mut Body) -> Result<(), ExportError> {
    // An acceleration is the derivative of a speed.
    for speed in
        builder.d.coordinates.iter().map(|own| builder.d.points[own.node].speed.clone()).collect::<Vec<_>>()
    {
        let rate = Formula::Call("der".into(), vec![Formula::Name(speed.clone())]);
        builder.rename_speed(&speed, rate);
    }
    let outputs = builder.outputs()?;
    let assigned = builder.lines.iter().filter_map(|line| match line {
        Line::Assignment(own) => Some(own.name.clone()),
        Line::Comment(_) => None,
    });
    let readings: Vec<String> = builder.d.outputs.iter().map(|signal| signal.identifier.clone()).collect();
    for name in assigned {
        let at = readings.iter().position(|own| *own == name);
        body.declarations.push(match at {
            Some(at) => {
                let channel = builder.d.outputs[at].channel;
                let words = quoted(&format!("{}, {}", channel.name, channel.unit));
                format!("Modelica.Blocks.Interfaces.RealOutput {name} {words}")
            }
            None => format!("Real {name}"),
        });
    }
    for line in
        written(&builder.lines, &MODELICA, "", "//", "").lines().filter(|line| !line.starts_with("//"))
    {
        let late = readings.iter().zip(&outputs).find(|(name, _)| line.starts_with(&format!("{name} = ")));
        body.equations.push(match late.and_then(|(name, output)| Some((name, output.delay?))) {
            Some((name, delay)) => {
                let delay = &builder.d.parameters[delay].identifier;
                format!("{name} = delay({}, {delay})", &line[name.len() + 3..])
            }
            None => line.to_owned(),
        });
    }
    let is_speed = |state: &State| state.meaning.is_empty();
    for state in builder.states.iter().filter(|state| !is_speed(state)) {
        body.declarations.push(format!(
            "Real {}(start=0, fixed=true) {}",
            state.name,
            quoted(&state.meaning)
        ));
        body.equations.push(format!("der({}) = {}", state.name, state.rate.written(&MODELICA)));
    }
    Ok(())
}
