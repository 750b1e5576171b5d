//! Simscape: a component file with the equations of motion.
//!
//! All quantities are numbers in SI without units, because the parameters of a model have units of any kind.

use std::fmt::Write as _;

use crate::{
    Exported, Target,
    description::Description,
    error::ExportError,
    formula::CARET,
    header,
    names::line,
    program::{Line, Program},
    python::delays_of_laws,
};

pub(crate) fn write(d: &mut Description<'_>) -> Result<Exported, ExportError> {
    let program = Program::of(d)?;
    let left_out = delays_of_laws(d, &program);
    let name = &d.identifier;
    let mut text = format!("component {name}\n% {}\n", line(&d.model.name));
    text.push_str(&header::commented(&header::lines(d, Target::Simscape, &left_out), "%"));
    text.push_str("% Use: put it on the path as it is called, and choose it in a Simscape Component block. Inputs and outputs are\n% physical signals; all quantities are numbers in SI.\n\nparameters\n");
    for (index, own) in d.parameters.iter().enumerate() {
        let _ = writeln!(
            text,
            "    {} = {{{:?}, '1'}}; % {}",
            own.identifier,
            own.value,
            header::parameter(d, index)
        );
    }
    text.push_str("end\n\ninputs\n");
    let changes = program
        .changes
        .iter()
        .map(|(input, name)| (name.as_str(), format!("rate of change of {}", d.inputs[*input].channel.name)));
    let inputs = d.inputs.iter().map(|signal| {
        (signal.identifier.as_str(), format!("{}, {}", signal.channel.name, signal.channel.unit))
    });
    for (name, words) in inputs.chain(changes) {
        let _ = writeln!(text, "    {name} = {{0, '1'}}; % {}", line(&words));
    }
    text.push_str("end\n\noutputs\n");
    for signal in &d.outputs {
        let words = line(&format!("{}, {}", signal.channel.name, signal.channel.unit));
        let _ = writeln!(text, "    {} = {{0, '1'}}; % {words}", signal.identifier);
    }
    text.push_str("end\n\nvariables\n");
    for state in &program.states {
        let start = "{value = {0, '1'}, priority = priority.high}";
        let _ = writeln!(text, "    {} = {start}; % {}", state.name, line(&state.meaning));
    }
    for unknown in &program.unknowns {
        let _ = writeln!(text, "    {} = {{0, '1'}}; % {}", unknown.name, line(&unknown.meaning));
    }
    text.push_str("end\n\n");
    text.push_str(&equations(d, &program));
    text.push_str("end\n");
    Ok(Exported { text, left_out })
}

/// Assignments as intermediates; balances, rates and readings as equations.
fn equations(d: &Description<'_>, program: &Program) -> String {
    let mut intermediates = String::from("intermediates\n    t = value(time, 's');\n");
    let mut equations = String::from("equations\n");
    for own in &program.lines {
        match own {
            Line::Comment(words) => intermediates.push_str(&format!("    % {}\n", line(words))),
            Line::Assignment(own) => {
                let formula = own.formula.written(&CARET);
                let output = d.outputs.iter().position(|signal| signal.identifier == own.name);
                match output.map(|output| program.outputs[output].delay) {
                    None => intermediates.push_str(&format!("    {} = {formula};\n", own.name)),
                    Some(None) => equations.push_str(&format!("    {} == {formula};\n", own.name)),
                    Some(Some(delay)) => {
                        let delay = &d.parameters[delay].identifier;
                        let _ =
                            writeln!(equations, "    {} == delay({formula}, {delay}*{{1, 's'}});", own.name);
                    }
                }
            }
        }
    }
    for state in &program.states {
        let _ =
            writeln!(equations, "    der({}) == ({})*{{1, '1/s'}};", state.name, state.rate.written(&CARET));
    }
    for unknown in &program.unknowns {
        let _ = writeln!(equations, "    0 == {};", unknown.balance.written(&CARET));
    }
    format!("{intermediates}end\n\n{equations}end\n")
}
