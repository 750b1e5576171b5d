//! Python: one file with numpy and scipy.

use socam_model::{ChannelTransform, Intersample};

use crate::{
    Exported, LeftOut, Target, description::Description, error::ExportError, formula::PYTHON, header,
    names::quoted, program::Program,
};

/// Code that does not depend on the model.
const SOLVER: &str = include_str!("python/solver.py");

pub(crate) fn write(d: &mut Description<'_>) -> Result<Exported, ExportError> {
    let program = Program::of(d)?;
    let left_out = delays_of_laws(d, &program);
    let mut text = header::commented(&header::lines(d, Target::Python, &left_out), "#");
    text.push_str("#\n# simulate(t, inputs) runs the model; read_inputs(t, columns) makes its inputs from a recording's columns.\n\n");
    text.push_str("from math import atan, cos, exp, log, pi, sin, sqrt, tanh\n\nimport numpy as np\nfrom scipy.integrate import solve_ivp\n");
    text.push_str("from scipy.interpolate import make_interp_spline\n\n");
    text.push_str("# Value (SI), unit, 95 % interval, source.\nPARAMETERS = {\n");
    for own in &d.parameters {
        let interval = own.ci95.map_or("None".into(), |[low, high]| format!("({low:?}, {high:?})"));
        let (name, unit, source) = (quoted(&own.name), quoted(&own.unit), quoted(&own.source));
        text.push_str(&format!("    {name}: ({:?}, {unit}, {interval}, {source}),\n", own.value));
    }
    text.push_str("}\n\n# Name, column, scale, offset, what is taken of the column, and how it moves between samples.\nINPUTS = [\n");
    for signal in &d.inputs {
        let channel = signal.channel;
        let take = match channel.transform {
            ChannelTransform::Rate => "\"rate\"".to_owned(),
            ChannelTransform::Cos(order) => format!("(\"cos\", {order:?})"),
            ChannelTransform::Sin(order) => format!("(\"sin\", {order:?})"),
            _ => "None".to_owned(),
        };
        let between = match channel.intersample() {
            Intersample::Hold => "hold",
            Intersample::Linear => "linear",
            Intersample::BandLimited => "band-limited",
        };
        let (name, column) = (quoted(&channel.name), quoted(&channel.column));
        text.push_str(&format!(
            "    ({name}, {column}, {:?}, {:?}, {take}, \"{between}\"),\n",
            channel.scale, channel.offset
        ));
    }
    text.push_str("]\n\n# Name, column, scale and offset of what the model predicts: SI value = scale times the column + offset.\nOUTPUTS = [\n");
    for signal in &d.outputs {
        let (name, column) = (quoted(&signal.channel.name), quoted(&signal.channel.column));
        let (scale, offset) = (signal.channel.scale, signal.channel.offset);
        text.push_str(&format!("    ({name}, {column}, {scale:?}, {offset:?}),\n"));
    }
    text.push_str("]\n");
    text.push_str(&tables(d, &program));
    text.push_str(&equations(d, &program));
    text.push_str(SOLVER);
    Ok(Exported { text, left_out })
}

/// A law at a sensor that is late acts on the late reading.
pub(crate) fn delays_of_laws(d: &Description<'_>, program: &Program) -> Vec<LeftOut> {
    let outputs = d.outputs.iter().zip(&program.outputs).filter(|(_, output)| output.delay.is_some());
    let several = outputs.filter(|(signal, _)| {
        d.model.effects.iter().filter(|used| used.place == signal.channel.name).count() > 1
    });
    several
        .map(|(signal, _)| {
            let why = "its other effects are delayed too, by the sensor's delay";
            LeftOut::new(format!("order of the effects at {}", signal.channel.name), why)
        })
        .collect()
}

/// States, delays and derivatives of inputs.
fn tables(d: &Description<'_>, program: &Program) -> String {
    let each = |names: Vec<String>| format!("[{}]", names.join(", "));
    let states = each(program.states.iter().map(|state| quoted(&state.meaning)).collect());
    let delays = program
        .outputs
        .iter()
        .map(|output| output.delay.map_or("None".to_owned(), |delay| quoted(&d.parameters[delay].name)));
    let changes = program.changes.iter().map(|(input, _)| input.to_string()).collect();
    format!(
        "\nSTATES = {states}\nUNKNOWNS = {}\n# Parameters by which outputs are late, and inputs whose derivative follows the inputs.\nDELAYS = {}\nCHANGES = {}\n\n",
        program.unknowns.len(),
        each(delays.collect()),
        each(changes)
    )
}

fn equations(d: &Description<'_>, program: &Program) -> String {
    let mut text = String::from(
        "\ndef equations(t, x, z, u, p):\n    \"\"\"Balances of the unknowns z, rates of the states x, and readings.\"\"\"\n",
    );
    let mut unpack = |names: Vec<&str>, from: &str| {
        if !names.is_empty() {
            let comma = if names.len() == 1 { "," } else { "" };
            text.push_str(&format!("    {}{comma} = {from}\n", names.join(", ")));
        }
    };
    unpack(d.parameters.iter().map(|own| own.identifier.as_str()).collect(), "p");
    unpack(program.states.iter().map(|state| state.name.as_str()).collect(), "x");
    unpack(program.unknowns.iter().map(|unknown| unknown.name.as_str()).collect(), "z");
    let derivatives = program.changes.iter().map(|(_, name)| name.as_str());
    unpack(d.inputs.iter().map(|signal| signal.identifier.as_str()).chain(derivatives).collect(), "u");
    text.push_str(&program.written(&PYTHON, "    ", "#", ""));
    let list = |formulas: Vec<String>| format!("[{}]", formulas.join(", "));
    let balances = list(program.unknowns.iter().map(|own| own.balance.written(&PYTHON)).collect());
    let rates = list(program.states.iter().map(|own| own.rate.written(&PYTHON)).collect());
    let readings = list(program.outputs.iter().map(|own| own.reading.written(&PYTHON)).collect());
    text.push_str(&format!("    return {balances}, {rates}, {readings}\n\n"));
    text
}
