//! `modelDescription.xml`.

use std::fmt::Write;

use crate::unit::{Causality, Unit, Variable};

/// The description of a unit.
#[must_use]
pub fn description(unit: &Unit) -> String {
    let model = unit.model();
    let mut units: Vec<&str> = unit.variables().iter().map(|variable| variable.unit.as_str()).collect();
    units.push("s");
    units.retain(|unit| !unit.is_empty());
    units.sort_unstable();
    units.dedup();
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"3.0\" modelName=\"{}\" instantiationToken=\"{}\" \
         description=\"{}\" generationTool=\"socam\" variableNamingConvention=\"flat\">\n  <CoSimulation modelIdentifier=\"{}\" \
         canHandleVariableCommunicationStepSize=\"true\"/>\n  <UnitDefinitions>\n",
        escaped(&model.name),
        token(&model.text),
        escaped(&model.description),
        identifier(&model.name)
    );
    for unit in units {
        let base = base(unit).map_or(String::new(), |base| format!("<BaseUnit{base}/>"));
        let _ = writeln!(text, "    <Unit name=\"{}\">{base}</Unit>", escaped(unit));
    }
    text.push_str(
        "  </UnitDefinitions>\n  <DefaultExperiment startTime=\"0\" stopTime=\"10\" stepSize=\"0.001\"/>\n  <ModelVariables>\n    \
         <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\" unit=\"s\"/>\n",
    );
    for (index, variable) in unit.variables().iter().enumerate() {
        text.push_str(&line(index + 1, variable));
    }
    text.push_str("  </ModelVariables>\n  <ModelStructure>\n");
    for element in ["Output", "InitialUnknown"] {
        for (index, variable) in unit.variables().iter().enumerate() {
            if variable.causality == Causality::Output {
                let _ = writeln!(text, "    <{element} valueReference=\"{}\"/>", index + 1);
            }
        }
    }
    text.push_str("  </ModelStructure>\n</fmiModelDescription>\n");
    text
}

fn line(reference: usize, variable: &Variable) -> String {
    let kind = match variable.causality {
        Causality::Input => "causality=\"input\" variability=\"continuous\"",
        Causality::Output => "causality=\"output\" variability=\"continuous\" initial=\"calculated\"",
        Causality::Parameter | Causality::State => {
            "causality=\"parameter\" variability=\"fixed\" initial=\"exact\""
        }
    };
    let attribute = |name: &str, value: &str| {
        if value.is_empty() { String::new() } else { format!(" {name}=\"{}\"", escaped(value)) }
    };
    let start =
        if variable.causality == Causality::Output { String::new() } else { variable.start.to_string() };
    format!(
        "    <Float64 name=\"{}\" valueReference=\"{reference}\" {kind}{}{}{}/>\n",
        escaped(&variable.name),
        attribute("start", &start),
        attribute("unit", &variable.unit),
        attribute("description", &variable.description)
    )
}

/// Text within an attribute; control characters, which XML has not, become spaces.
fn escaped(text: &str) -> String {
    let plain = text.replace(char::is_control, " ");
    maud::html! { (plain) }.into_string()
}

/// Ties a library's instance to its model: FNV-1a of the model's text.
pub(crate) fn token(model_text: &str) -> String {
    let hash = model_text.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("socam-{hash:016x}")
}

/// The name as a C identifier: name of the shared library.
pub(crate) fn identifier(name: &str) -> String {
    let plain = name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
    format!("model_{plain}")
}

/// Exponents of SI base units as attributes; `None` for a unit that is not composed of known ones.
fn base(unit: &str) -> Option<String> {
    const NAMES: [&str; 6] = ["kg", "m", "s", "A", "K", "rad"];
    let mut exponents = [0; 6];
    for (part, sign) in unit.split('/').zip([1, -1]) {
        for token in part.split([' ', '(', ')']).filter(|token| !token.is_empty() && *token != "1") {
            let symbol = token.trim_end_matches(|c: char| c.is_ascii_digit());
            let power: i32 =
                if symbol.len() < token.len() { token[symbol.len()..].parse().ok()? } else { 1 };
            let own = match symbol {
                "kg" => [1, 0, 0, 0, 0, 0],
                "m" => [0, 1, 0, 0, 0, 0],
                "s" => [0, 0, 1, 0, 0, 0],
                "A" => [0, 0, 0, 1, 0, 0],
                "K" => [0, 0, 0, 0, 1, 0],
                "rad" => [0, 0, 0, 0, 0, 1],
                "N" => [1, 1, -2, 0, 0, 0],
                "V" => [1, 2, -3, -1, 0, 0],
                _ => return None,
            };
            exponents.iter_mut().zip(own).for_each(|(sum, own)| *sum += sign * power * own);
        }
    }
    if unit.split('/').count() > 2 {
        return None;
    }
    let known = NAMES.iter().zip(exponents).filter(|(_, power)| *power != 0);
    Some(known.map(|(name, power)| format!(" {name}=\"{power}\"")).collect())
}
