//! A corrected joint back into its description.

use roxmltree::{Document, Node};

use crate::error::{Result, RobotError};
use crate::xml::child;

/// Numbers of a corrected model of a joint, SI; `None` where the model has none.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Corrections {
    /// Inertia at the joint, kg m² (kg), the drive's included.
    pub inertia: Option<f64>,
    /// N m s/rad (N s/m).
    pub damping: Option<f64>,
    /// N m (N).
    pub friction: Option<f64>,
    /// N m/rad (N/m).
    pub stiffness: Option<f64>,
}

/// One change of the text.
struct Edit {
    from: usize,
    to: usize,
    text: String,
}

/// Puts numbers into the joint `name` of a description whose inertia behind the joint is `behind`, and changes nothing else of its text.
/// Returns the text, and what the syntax cannot hold, in sentences.
///
/// # Errors
/// When the text is no description, or has no such joint in this file.
pub fn patch(text: &str, name: &str, behind: f64, corrected: &Corrections) -> Result<(String, Vec<String>)> {
    let document = Document::parse(text)?;
    let root = document.root_element();
    let joint = root.descendants().find(|node| {
        node.has_tag_name("joint")
            && node.attribute("name") == Some(name)
            && node.ancestors().all(|above| !above.has_tag_name("transmission"))
    });
    let joint = joint.ok_or_else(|| {
        RobotError::Whole(format!(
            "holds no joint `{name}` itself; patch the file that does, perhaps one that it includes"
        ))
    })?;
    let mut left_out = Vec::new();
    let mut edits = Vec::new();
    match root.tag_name().name() {
        "mujoco" => {
            let armature = corrected.inertia.map(|inertia| inertia - behind);
            if armature.is_some_and(|armature| armature < 0.0) {
                left_out.push(format!(
                    "the inertia, which is {:.3e} below that of the bodies: correct their masses",
                    -armature.unwrap_or(0.0)
                ));
            }
            let armature = armature.filter(|armature| *armature >= 0.0);
            let all = [
                ("damping", corrected.damping),
                ("frictionloss", corrected.friction),
                ("armature", armature),
                ("stiffness", corrected.stiffness),
            ];
            edits.extend(given(&all).filter_map(|(key, value)| attribute(text, joint, key, value)));
        }
        "robot" => {
            left_out.extend(corrected.stiffness.map(|_| "the spring: URDF has none at a joint".to_owned()));
            left_out.extend(differs(corrected.inertia, behind));
            let all = [("damping", corrected.damping), ("friction", corrected.friction)];
            match child(joint, "dynamics") {
                Some(dynamics) => {
                    edits
                        .extend(given(&all).filter_map(|(key, value)| attribute(text, dynamics, key, value)));
                }
                None => {
                    let all: Vec<String> =
                        given(&all).map(|(key, value)| format!("{key}=\"{value}\"")).collect();
                    edits.push(inserted(text, joint, &format!("<dynamics {}/>", all.join(" "))));
                }
            }
        }
        _ => {
            left_out.extend(differs(corrected.inertia, behind));
            let axis = child(joint, "axis");
            let axis = axis.ok_or_else(|| RobotError::at(joint, "has no <axis>"))?;
            let all = [
                ("damping", corrected.damping),
                ("friction", corrected.friction),
                ("spring_stiffness", corrected.stiffness),
            ];
            let element = |key: &str, value: f64| format!("<{key}>{value}</{key}>");
            match child(axis, "dynamics") {
                Some(dynamics) => {
                    for (key, value) in given(&all) {
                        match child(dynamics, key) {
                            Some(old) => edits.push(Edit {
                                from: old.range().start,
                                to: old.range().end,
                                text: element(key, value),
                            }),
                            None => edits.push(inserted(text, dynamics, &element(key, value))),
                        }
                    }
                }
                None => {
                    let all: String = given(&all).map(|(key, value)| element(key, value)).collect();
                    edits.push(inserted(text, axis, &format!("<dynamics>{all}</dynamics>")));
                }
            }
        }
    }
    edits.sort_by_key(|edit| std::cmp::Reverse(edit.from));
    let mut patched = text.to_owned();
    for Edit { from, to, text } in edits {
        patched.replace_range(from..to, &text);
    }
    Document::parse(&patched)?;
    Ok((patched, left_out))
}

/// The numbers that the model has, by their keys.
fn given<'k>(all: &[(&'k str, Option<f64>)]) -> impl Iterator<Item = (&'k str, f64)> {
    all.iter().filter_map(|(key, value)| Some((*key, (*value)?)))
}

/// A sentence where the corrected inertia is not that of the bodies.
fn differs(inertia: Option<f64>, behind: f64) -> Option<String> {
    const SAME: f64 = 1e-6;
    let inertia = inertia.filter(|inertia| (inertia / behind - 1.0).abs() > SAME)?;
    Some(format!(
        "the inertia {inertia:.6}, where the bodies have {behind:.6}: this syntax has none for the drive"
    ))
}

/// The change of one attribute; `None` where it says the same already.
fn attribute(text: &str, node: Node<'_, '_>, key: &str, value: f64) -> Option<Edit> {
    if let Some(old) = node.attribute_node(key) {
        let is_same = old.value().trim().parse::<f64>().is_ok_and(|old| old == value);
        let range = old.range_value();
        return (!is_same).then(|| Edit { from: range.start, to: range.end, text: value.to_string() });
    }
    if value == 0.0 {
        return None;
    }
    // Behind the name of the element.
    let start = node.range().start;
    let tag = &text[start..];
    let end = start + tag.find(|c: char| c.is_whitespace() || c == '>' || c == '/').unwrap_or(tag.len());
    Some(Edit { from: end, to: end, text: format!(" {key}=\"{value}\"") })
}

/// A new last child of an element.
fn inserted(text: &str, node: Node<'_, '_>, new: &str) -> Edit {
    let range = node.range();
    let own = &text[range.clone()];
    match own.rfind("</") {
        Some(end) => Edit { from: range.start + end, to: range.start + end, text: new.to_owned() },
        // `<dynamics/>` gets an end of its own.
        None => {
            let name = node.tag_name().name();
            Edit { from: range.end - 2, to: range.end, text: format!(">{new}</{name}>") }
        }
    }
}
