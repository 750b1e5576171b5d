//! `modelDescription.xml`: what an importer knows of an FMU.

use std::io;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use socam_model::Model;

use crate::variables::{Variable, VariableRole, can_exchange};

/// Name of the shared library without its extension.
pub(crate) const MODEL_IDENTIFIER: &str = "socam_fmu";

const TOKEN: crc::Crc<u64> = crc::Crc::<u64>::new(&crc::CRC_64_XZ);

/// The token that ties a description to its model file and to the version of this crate.
pub(crate) fn token(model_text: &str) -> String {
    format!("socam-{}-{:016x}", env!("CARGO_PKG_VERSION"), TOKEN.checksum(model_text.as_bytes()))
}

/// The description of a model with these variables.
pub(crate) fn describe(model: &Model, variables: &[Variable]) -> io::Result<Vec<u8>> {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let (name, about) = (printable(&model.name), printable(&model.description));
    let token = token(&model.text);
    let root = writer.create_element("fmiModelDescription").with_attributes([
        ("fmiVersion", "3.0"),
        ("modelName", name.as_str()),
        ("description", about.as_str()),
        ("instantiationToken", token.as_str()),
        ("generationTool", concat!("socam ", env!("CARGO_PKG_VERSION"))),
        ("variableNamingConvention", "structured"),
    ]);
    root.write_inner_content(|writer| {
        if can_exchange(model) {
            writer
                .create_element("ModelExchange")
                .with_attributes([("modelIdentifier", MODEL_IDENTIFIER), ("canGetAndSetFMUState", "true")])
                .write_empty()?;
        }
        writer
            .create_element("CoSimulation")
            .with_attributes([
                ("modelIdentifier", MODEL_IDENTIFIER),
                ("canGetAndSetFMUState", "true"),
                ("canHandleVariableCommunicationStepSize", "true"),
            ])
            .write_empty()?;
        writer.create_element("UnitDefinitions").write_inner_content(|writer| units(writer, variables))?;
        writer
            .create_element("DefaultExperiment")
            .with_attributes([("startTime", "0"), ("stopTime", "1"), ("stepSize", "0.001")])
            .write_empty()?;
        writer.create_element("ModelVariables").write_inner_content(|writer| {
            (0..variables.len()).try_for_each(|reference| variable(writer, variables, reference))
        })?;
        writer.create_element("ModelStructure").write_inner_content(|writer| structure(writer, variables))?;
        Ok(())
    })?;
    Ok(writer.into_inner())
}

fn variable(writer: &mut Writer<Vec<u8>>, variables: &[Variable], reference: usize) -> io::Result<()> {
    let variable = &variables[reference];
    let (causality, variability, initial) = match variable.kind {
        VariableRole::Time => ("independent", "continuous", None),
        VariableRole::Input(_) => ("input", "continuous", None),
        VariableRole::Output(_) => ("output", "continuous", Some("calculated")),
        VariableRole::Parameter(_) => ("parameter", "tunable", Some("exact")),
        VariableRole::State(_) => ("local", "continuous", Some("exact")),
        VariableRole::Derivative(_) => ("local", "continuous", Some("calculated")),
    };
    let mut attributes = vec![
        ("name", variable.name.clone()),
        ("valueReference", reference.to_string()),
        ("causality", causality.into()),
        ("variability", variability.into()),
    ];
    attributes.extend(initial.map(|initial| ("initial", initial.into())));
    attributes.extend(variable.start.map(|start| ("start", start.to_string())));
    if let VariableRole::Derivative(index) = variable.kind {
        let state = variables.iter().position(|other| other.kind == VariableRole::State(index));
        attributes.extend(state.map(|state| ("derivative", state.to_string())));
    }
    let (least, greatest) = variable.bounds;
    for (name, bound) in [("min", least), ("max", greatest)] {
        if bound.is_finite() {
            attributes.push((name, bound.to_string()));
        }
    }
    for (name, text) in [("unit", &variable.unit), ("description", &variable.description)] {
        if !text.is_empty() {
            attributes.push((name, printable(text)));
        }
    }
    let attributes = attributes.iter().map(|(name, value)| (*name, value.as_str()));
    writer.create_element("Float64").with_attributes(attributes).write_empty()?;
    Ok(())
}

/// Writes the model structure. Each output and derivative depends on all variables, which is what a list without dependencies
/// means.
fn structure(writer: &mut Writer<Vec<u8>>, variables: &[Variable]) -> io::Result<()> {
    let is_output = |variable: &Variable| matches!(variable.kind, VariableRole::Output(_));
    let is_derivative = |variable: &Variable| matches!(variable.kind, VariableRole::Derivative(_));
    for (reference, _) in variables.iter().enumerate().filter(|(_, v)| is_output(v)) {
        unknown(writer, "Output", reference)?;
    }
    for (reference, _) in variables.iter().enumerate().filter(|(_, v)| is_derivative(v)) {
        unknown(writer, "ContinuousStateDerivative", reference)?;
    }
    for (reference, _) in variables.iter().enumerate().filter(|(_, v)| is_output(v) || is_derivative(v)) {
        unknown(writer, "InitialUnknown", reference)?;
    }
    Ok(())
}

fn unknown(writer: &mut Writer<Vec<u8>>, element: &str, reference: usize) -> io::Result<()> {
    let reference = reference.to_string();
    writer.create_element(element).with_attribute(("valueReference", reference.as_str())).write_empty()?;
    Ok(())
}

/// Writes every unit once, with its exponents of base units.
fn units(writer: &mut Writer<Vec<u8>>, variables: &[Variable]) -> io::Result<()> {
    let named: std::collections::BTreeSet<&str> =
        variables.iter().map(|variable| variable.unit.as_str()).filter(|unit| !unit.is_empty()).collect();
    for unit in named {
        let exponents = exponents(unit);
        let element = writer.create_element("Unit").with_attribute(("name", unit));
        element.write_inner_content(|writer| {
            if let Some(exponents) = exponents {
                let written: Vec<_> =
                    exponents.iter().map(|(base, power)| (*base, power.to_string())).collect();
                let attributes = written.iter().map(|(base, power)| (*base, power.as_str()));
                writer.create_element("BaseUnit").with_attributes(attributes).write_empty()?;
            }
            Ok(())
        })?;
    }
    Ok(())
}

/// Exponents other than 0 of an SI unit. FMI counts radians, which the dimension of a unit does not.
fn exponents(unit: &str) -> Option<Vec<(&'static str, i32)>> {
    let parsed = socam_units::parse(unit)?;
    let [kg, m, s, ampere, kelvin] = parsed.dimension.map(i32::from);
    let rad = i32::from(parsed.product.radians());
    let bases = [("kg", kg), ("m", m), ("s", s), ("A", ampere), ("K", kelvin), ("rad", rad)];
    // A unit that is not SI would need a factor.
    (parsed.factor == 1.0).then(|| bases.into_iter().filter(|(_, power)| *power != 0).collect())
}

/// The text with blanks for characters that XML cannot hold.
fn printable(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') { ' ' } else { c })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_base_units_with_radians() {
        assert_eq!(exponents("N m/rad").unwrap(), [("kg", 1), ("m", 2), ("s", -2), ("rad", -1)]);
        assert_eq!(exponents("N m s2/rad2").unwrap().last(), Some(&("rad", -2)));
        assert_eq!(exponents("V s/m").unwrap(), [("kg", 1), ("m", 1), ("s", -2), ("A", -1)]);
        assert_eq!(exponents("1").unwrap(), []);
        assert_eq!(exponents("rpm"), None);
    }
}
