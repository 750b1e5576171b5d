//! MATLAB: a function file for `idnlgrey` and `nlgreyest`. Octave runs all but these two.

use std::fmt::Write as _;

use crate::{
    Exported, LeftOut, Target, description::Description, error::ExportError, formula::CARET, header,
    names::single_quoted, program::Program, python::delays_of_laws,
};

/// Code that does not depend on the model.
const SOLVER: &str = include_str!("matlab/solver.m");

pub(crate) fn write(d: &mut Description<'_>) -> Result<Exported, ExportError> {
    let program = Program::of(d)?;
    let mut left_out = delays_of_laws(d, &program);
    for (signal, _) in d.outputs.iter().zip(&program.outputs).filter(|(_, output)| output.delay.is_some()) {
        let why =
            "it is held by the simulation of this file and not by nlgreyest, which has no delays of outputs";
        left_out.push(LeftOut::new(format!("delay of {}", signal.channel.name), why));
    }
    for (input, _) in &program.changes {
        let why = "its derivative is an input of its own for nlgreyest, behind the others";
        left_out.push(LeftOut::new(format!("delay of {}", d.inputs[*input].channel.name), why));
    }
    let name = &d.identifier;
    let mut text = format!("function varargout = {name}(varargin)\n");
    text.push_str(&header::commented(&header::lines(d, Target::Matlab, &left_out), "%"));
    let usage = [
        String::new(),
        format!("The file must be called {name}.m."),
        format!("  s = {name}();           states, inputs, outputs, and parameters for idnlgrey"),
        format!(
            "  y = {name}(t, u);        outputs at the times t for the inputs u, one column each; also in Octave"
        ),
        format!("  y = {name}(t, u, p);     the same with other values of the parameters"),
        "  data = iddata(y, u, Ts);  and, with the System Identification Toolbox:".into(),
        format!("  sys = idnlgrey('{name}', s.order, s.parameters, s.start, 0);"),
        "  sys = nlgreyest(data, sys);".into(),
        format!("  [dx, y] = {name}(t, x, u, parameters...)  is what idnlgrey calls."),
    ];
    text.push_str(&header::commented(&usage, "%"));
    text.push_str("if nargin == 0\n    varargout = {information()};\nelseif nargin <= 3\n    varargout = {simulate(varargin{:})};\nelse\n");
    let count = d.parameters.len();
    let _ = write!(
        text,
        "    [t, x, u] = varargin{{1:3}};\n    x = x(:); u = u(:);\n    p = zeros({count}, 1);\n    for k = 1:{count}, p(k) = varargin{{3 + k}}; end\n    [~, rates, readings] = balances(t, x, solve(t, x, u, p), u, p);\n    varargout = {{rates, readings}};\nend\nend\n"
    );
    text.push_str(&information(d, &program));
    text.push_str(&equations(d, &program));
    text.push_str(SOLVER);
    Ok(Exported { text, left_out })
}

fn information(d: &Description<'_>, program: &Program) -> String {
    let cells = |names: Vec<String>| format!("{{{}}}", names.join(", "));
    let names =
        |names: &mut dyn Iterator<Item = &String>| cells(names.map(|name| single_quoted(name)).collect());
    let states = names(&mut program.states.iter().map(|state| &state.meaning));
    let outputs = names(&mut d.outputs.iter().map(|signal| &signal.channel.name));
    let inputs = names(&mut d.inputs.iter().map(|signal| &signal.channel.name));
    let (ins, outs) = (d.inputs.len() + program.changes.len(), d.outputs.len());
    let count = program.states.len();
    let mut text = String::from("\nfunction s = information()\n");
    let _ = write!(
        text,
        "s.states = {states};\ns.inputs = {inputs};\ns.outputs = {outputs};\ns.order = [{outs} {ins} {count}];\ns.start = zeros({count}, 1);\n",
    );
    for (index, own) in d.parameters.iter().enumerate() {
        let bound = |value: f64| match value {
            f64::INFINITY => "Inf".to_owned(),
            f64::NEG_INFINITY => "-Inf".to_owned(),
            value => format!("{value:?}"),
        };
        let interval = own.ci95.map_or("[]".to_owned(), |[low, high]| format!("[{low:?} {high:?}]"));
        let _ = write!(
            text,
            "s.parameters({at}, 1) = struct('Name', {}, 'Unit', {}, 'Value', {:?}, 'Minimum', {}, 'Maximum', {}, 'Fixed', {});\ns.ci95{{{at}}} = {interval};\n",
            single_quoted(&own.name),
            single_quoted(&own.unit),
            own.value,
            bound(own.bounds.0),
            bound(own.bounds.1),
            own.fixed,
            at = index + 1,
        );
    }
    let kinds =
        cells(d.inputs.iter().map(|signal| single_quoted(signal.channel.intersample().name())).collect());
    let numbers = |numbers: Vec<usize>| {
        format!("[{}]", numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(" "))
    };
    let changes = numbers(program.changes.iter().map(|(input, _)| input + 1).collect());
    let delays =
        numbers(program.outputs.iter().map(|output| output.delay.map_or(0, |delay| delay + 1)).collect());
    let _ = write!(
        text,
        "end\n\nfunction p = values()\ns = information();\np = [s.parameters.Value].';\nend\n\nfunction [kinds, changes, delays] = behaviour()\n% How inputs move between samples, inputs whose derivative follows them, and parameters by which outputs are late.\nkinds = {kinds};\nchanges = {changes};\ndelays = {delays};\nend\n\nfunction n = unknowns()\nn = {};\nend\n\nfunction n = state_count()\nn = {count};\nend\n\nfunction n = output_count()\nn = {outs};\nend\n",
        program.unknowns.len(),
    );
    text
}

fn equations(d: &Description<'_>, program: &Program) -> String {
    let mut text = String::from(
        "\nfunction [r, rates, readings] = balances(t, x, z, u, p)\n% Balances of the unknowns z, rates of the states x, and readings.\n",
    );
    let mut unpack = |names: &mut dyn Iterator<Item = &str>, from: &str| {
        for (index, name) in names.enumerate() {
            let _ = writeln!(text, "{name} = {from}({});", index + 1);
        }
    };
    unpack(&mut d.parameters.iter().map(|own| own.identifier.as_str()), "p");
    unpack(&mut program.states.iter().map(|state| state.name.as_str()), "x");
    unpack(&mut program.unknowns.iter().map(|unknown| unknown.name.as_str()), "z");
    let derivatives = program.changes.iter().map(|(_, name)| name.as_str());
    unpack(&mut d.inputs.iter().map(|signal| signal.identifier.as_str()).chain(derivatives), "u");
    text.push_str(&program.written(&CARET, "", "%", ";"));
    let column = |formulas: Vec<String>| format!("[{}]", formulas.join("; "));
    let balances = column(program.unknowns.iter().map(|own| own.balance.written(&CARET)).collect());
    let rates = column(program.states.iter().map(|own| own.rate.written(&CARET)).collect());
    let readings = column(program.outputs.iter().map(|own| own.reading.written(&CARET)).collect());
    let _ = writeln!(text, "r = {balances};\nrates = {rates};\nreadings = {readings};\nend");
    text
}
