//! Numbers and vectors in attributes and texts.

use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use crate::error::{Result, RobotError};

/// The numbers of a text.
pub(crate) fn numbers(node: Node<'_, '_>, what: &str, text: &str) -> Result<Vec<f64>> {
    let each = text.split_whitespace().map(|word| {
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| {
            RobotError::at(node, format!("`{what}` holds `{word}`, where a number was expected"))
        })
    });
    each.collect()
}

/// The number of an attribute, if it is there.
pub(crate) fn number(node: Node<'_, '_>, name: &str) -> Result<Option<f64>> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    Ok(numbers(node, name, text)?.first().copied())
}

/// The vector of an attribute, if it is there.
pub(crate) fn vector(node: Node<'_, '_>, name: &str) -> Result<Option<Vector3<f64>>> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    vector_of(node, name, text).map(Some)
}

pub(crate) fn vector_of(node: Node<'_, '_>, name: &str, text: &str) -> Result<Vector3<f64>> {
    let read = numbers(node, name, text)?;
    let [x, y, z] = read.as_slice() else {
        return Err(RobotError::at(node, format!("`{name}` has {} numbers; expected three", read.len())));
    };
    Ok(Vector3::new(*x, *y, *z))
}

/// A pose of position and angles about the fixed axes x, y, z, rad.
pub(crate) fn pose(position: Vector3<f64>, angles: Vector3<f64>) -> Isometry3<f64> {
    let rotation = Rotation3::from_euler_angles(angles.x, angles.y, angles.z);
    Isometry3::from_parts(Translation3::from(position), UnitQuaternion::from_rotation_matrix(&rotation))
}

/// A child element by name.
pub(crate) fn child<'a, 'd>(node: Node<'a, 'd>, name: &str) -> Option<Node<'a, 'd>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// The name of an element, or an error.
pub(crate) fn name_of(node: Node<'_, '_>) -> Result<String> {
    let name = node.attribute("name").map(str::to_owned);
    name.ok_or_else(|| RobotError::at(node, format!("this <{}> has no name", node.tag_name().name())))
}

/// The number in the text of a child, if it is there.
pub(crate) fn text_number(node: Node<'_, '_>, name: &str) -> Result<Option<f64>> {
    let Some(child) = child(node, name) else { return Ok(None) };
    Ok(numbers(child, name, child.text().unwrap_or(""))?.first().copied())
}
