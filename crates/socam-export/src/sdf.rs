//! SDF: links that hang on one another by joints with springs; gears are joints that mimic others.
//!
//! A joint with a spring is between two links, and a joint to the world holds a bearing's drag. A link has one joint, so that of the links
//! which springs join only one, the root, has a bearing that drags.

mod tree;

use crate::{
    Exported, LeftOut, Target,
    description::Description,
    error::ExportError,
    header,
    multibody::{self, Load},
    xml::{Xml, attribute, numbers},
};
use tree::{Holder, Tree};

pub(crate) fn write(d: &Description<'_>) -> Result<Exported, ExportError> {
    let mut left_out = Vec::new();
    let Some(least) = multibody::least_inertia(d) else {
        return Err(ExportError::NoMotion { target: "SDF", why: "no part of it has inertia".into() });
    };
    let loads = multibody::loads(d, "SDF", &mut left_out);
    let tree = Tree::of(d, &loads, &mut left_out);
    for node in (0..d.points.len()).filter(|node| multibody::inertia(d, *node) == 0.0) {
        let why = format!("it is massless and gets an inertia of {least:.3e}");
        left_out.push(LeftOut::new(format!("node {}", d.points[node].name), why));
    }
    let mut xml = Xml::new()?;
    xml.comment(&header::lines(d, Target::Sdf, &left_out))?;
    xml.open("sdf", &[attribute("version", "1.11")])?;
    xml.open("model", &[attribute("name", &d.identifier)])?;
    for node in 0..d.points.len() {
        link(&mut xml, d, node, least)?;
    }
    for node in 0..d.points.len() {
        joint(&mut xml, d, &tree, node)?;
    }
    Ok(Exported { text: xml.finish()?, left_out })
}

fn link(xml: &mut Xml, d: &Description<'_>, node: usize, least: f64) -> Result<(), ExportError> {
    let inertia = multibody::inertia(d, node).max(least);
    let (mass, about) = if d.is_rotation() { (1.0, inertia) } else { (inertia, 1e-3) };
    let place = numbers(&[0.2 * node as f64, 0.0, 0.5, 0.0, 0.0, 0.0]);
    xml.open("link", &[attribute("name", &d.points[node].identifier)])?;
    xml.text("pose", &[], &place)?;
    xml.open("inertial", &[])?;
    xml.text("mass", &[], &format!("{mass:?}"))?;
    xml.open("inertia", &[])?;
    for (key, value) in
        [("ixx", about), ("ixy", 0.0), ("ixz", 0.0), ("iyy", about), ("iyz", 0.0), ("izz", about)]
    {
        xml.text(key, &[], &format!("{value:?}"))?;
    }
    xml.close()?;
    xml.close()?;
    xml.open("visual", &[attribute("name", "visual")])?;
    xml.text("pose", &[], "0 0 0 0 1.5707963267948966 0")?;
    xml.open("geometry", &[])?;
    xml.open("cylinder", &[])?;
    xml.text("radius", &[], "0.05")?;
    xml.text("length", &[], "0.1")?;
    xml.close()?;
    xml.close()?;
    xml.close()?;
    xml.close()
}

fn joint(xml: &mut Xml, d: &Description<'_>, tree: &Tree, node: usize) -> Result<(), ExportError> {
    let (kind, far) = if d.is_rotation() { ("revolute", 1e16) } else { ("prismatic", 1e3) };
    let (parent, kind, load, stiffness) = match tree.holder[node] {
        Holder::World => ("world".to_owned(), kind, tree.at_root[node], tree.to_ground[node]),
        Holder::Shaft(other) => (d.points[other].identifier.clone(), "fixed", Load::default(), 0.0),
        Holder::Spring(other, spring) => {
            let spring = &d.model.springs[spring];
            let damping = spring.damping.map_or(0.0, |damping| d.value(damping));
            let load = Load { damping, dry: 0.0 };
            (d.points[other].identifier.clone(), kind, load, d.value(spring.stiffness))
        }
    };
    let name = |node: usize| d.points[node].joint.clone();
    xml.open("joint", &[attribute("name", name(node)), attribute("type", kind)])?;
    xml.text("parent", &[], &parent)?;
    xml.text("child", &[], &d.points[node].identifier)?;
    if kind != "fixed" {
        xml.open("axis", &[])?;
        xml.text("xyz", &[], "1 0 0")?;
        if let Some((leader, ratio)) = tree.mimics[node] {
            xml.open("mimic", &[attribute("joint", name(leader)), attribute("axis", "axis")])?;
            xml.text("multiplier", &[], &format!("{ratio:?}"))?;
            xml.text("offset", &[], "0")?;
            xml.text("reference", &[], "0")?;
            xml.close()?;
        }
        xml.open("limit", &[])?;
        xml.text("lower", &[], &format!("{:?}", -far))?;
        xml.text("upper", &[], &format!("{far:?}"))?;
        xml.close()?;
        xml.open("dynamics", &[])?;
        for (key, value) in [
            ("damping", load.damping),
            ("friction", load.dry),
            ("spring_reference", 0.0),
            ("spring_stiffness", stiffness),
        ] {
            xml.text(key, &[], &format!("{value:?}"))?;
        }
        xml.close()?;
        xml.close()?;
    }
    xml.close()
}
