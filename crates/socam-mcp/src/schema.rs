//! The arguments of a tool as a JSON Schema.

use std::path::Path;

use serde_json::{Map, Value, json};
use socam_job::options::{Described, ValueType};

use crate::{
    error::Result,
    tools::{Argument, Takes, Tool},
};

/// The arguments that a tool has on a server that may write into `folder`, if there is one.
pub(crate) fn arguments<'t>(tool: &'t Tool, folder: Option<&Path>) -> impl Iterator<Item = &'t Argument> {
    let may_write = folder.is_some();
    tool.arguments.iter().filter(move |one| may_write || !one.is_written())
}

/// Whether a server that may write into `folder` has the tool: all that it requires.
pub(crate) fn is_offered(tool: &Tool, folder: Option<&Path>) -> bool {
    folder.is_some() || tool.arguments.iter().all(|one| !(one.is_required && one.is_written()))
}

/// The schema of a tool's arguments.
///
/// # Errors
/// Where the description of its task's options is inconsistent.
pub(crate) fn schema(tool: &Tool, folder: Option<&Path>) -> Result<Map<String, Value>> {
    let mut properties = Map::new();
    for one in arguments(tool, folder) {
        properties.insert(one.name.into(), of_argument(one));
    }
    for option in tool.task.map(socam_job::described).transpose()?.unwrap_or_default() {
        properties.insert(option.name.clone(), of_option(&option));
    }
    let required: Vec<&str> =
        arguments(tool, folder).filter(|one| one.is_required).map(|one| one.name).collect();
    let schema = json!({
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    Ok(match schema {
        Value::Object(schema) => schema,
        _ => Map::new(),
    })
}

fn of_argument(argument: &Argument) -> Value {
    let about = argument.about;
    match argument.takes {
        Takes::Files => {
            json!({ "type": "array", "items": { "type": "string" }, "minItems": 1, "description": about })
        }
        Takes::Flagged(_) => json!({ "type": "array", "items": { "type": "string" }, "description": about }),
        Takes::Word(_, words) => json!({ "type": "string", "enum": words, "description": about }),
        Takes::File | Takes::One(_) => json!({ "type": "string", "description": about }),
        Takes::Written(_) => {
            let about =
                format!("{about}; a path below the folder that may be written, of no file that exists");
            json!({ "type": "string", "description": about })
        }
    }
}

fn of_option(option: &Described) -> Value {
    let kind = match option.kind {
        ValueType::Switch => "boolean",
        ValueType::Whole => "integer",
        ValueType::Number => "number",
        ValueType::Choice | ValueType::Path | ValueType::Text => "string",
    };
    let mut one = json!({ "type": kind });
    if !option.choices.is_empty() {
        one["enum"] = json!(option.choices);
    }
    let mut schema = if option.is_list { json!({ "type": "array", "items": one }) } else { one };
    let form = if option.value_name.is_empty() { String::new() } else { format!(" ({})", option.value_name) };
    schema["description"] = json!(format!("{}{form}", option.help));
    let is_stated = !option.default.is_null() && option.default.as_array().is_none_or(|all| !all.is_empty());
    if is_stated {
        schema["default"] = option.default.clone();
    }
    schema
}
