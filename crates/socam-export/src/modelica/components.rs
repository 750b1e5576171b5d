//! Components of the library: inertias, springs, gears, bearings.

use super::{Body, Library};
use crate::{description::Description, names::quoted};

/// Declares the linear network and ties it.
pub(super) fn declare(d: &mut Description<'_>, library: &Library, body: &mut Body) {
    let (package, angle) = (library.package, library.angle);
    for node in 0..d.points.len() {
        let point = &d.points[node];
        let own: Vec<&str> =
            point.inertias.iter().map(|own| d.parameters[*own].identifier.as_str()).collect();
        if !own.is_empty() {
            let (kind, value) = (library.inertia, library.inertia_value);
            let name = &point.identifier;
            let sum = own.join(" + ");
            body.declarations
                .push(format!("{package}.Components.{kind} {name}({value}={sum}) {}", quoted(&point.name)));
            body.anchor[node] = Some(format!("{name}.flange_a"));
        } else if !is_tied(d, node) {
            // A point of a rigid shaft only.
            let name = &point.identifier;
            let (kind, value) = (library.inertia, library.inertia_value);
            body.declarations
                .push(format!("{package}.Components.{kind} {name}({value}=0) {}", quoted(&point.name)));
            body.anchor[node] = Some(format!("{name}.flange_a"));
        }
    }
    for (index, spring) in d.model.springs.iter().enumerate() {
        let name = &d.springs[index];
        let stiffness = &d.parameters[spring.stiffness].identifier;
        let damping = spring.damping.map(|damping| &d.parameters[damping].identifier);
        let words = quoted(&spring.name);
        body.declarations.push(match damping {
            Some(damping) => {
                format!("{package}.Components.SpringDamper {name}(c={stiffness}, d={damping}) {words}")
            }
            None => format!("{package}.Components.Spring {name}(c={stiffness}) {words}"),
        });
        body.tie(spring.from, format!("{name}.flange_a"));
        match spring.to {
            Some(to) => body.tie(to, format!("{name}.flange_b")),
            None => ground(d, library, body, index),
        }
    }
    for (index, gear) in d.model.gears.iter().enumerate() {
        let (name, ratio) = (&d.gears[index], &d.parameters[gear.ratio].identifier);
        let kind =
            if d.is_rotation() { format!("{package}.Components.IdealGear") } else { "Lever".to_owned() };
        body.declarations.push(format!("{kind} {name}(ratio={ratio}) {}", quoted(&gear.name)));
        body.tie(gear.from, format!("{name}.flange_a"));
        body.tie(gear.to, format!("{name}.flange_b"));
    }
    for (index, bearing) in d.model.bearings.iter().enumerate() {
        let Some(damping) = bearing.damping else { continue };
        let (name, damping) = (&d.bearings[index], &d.parameters[damping].identifier);
        body.declarations
            .push(format!("{package}.Components.Damper {name}(d={damping}) {}", quoted(&bearing.name)));
        body.declarations.push(format!("{package}.Components.Fixed {name}_housing"));
        body.equations.push(format!("connect({name}.flange_b, {name}_housing.flange)"));
        body.tie(bearing.node, format!("{name}.flange_a"));
    }
    for shaft in &d.model.shafts {
        let (from, to) = shaft.nodes;
        match (body.anchor[from].clone(), body.anchor[to].clone()) {
            (Some(from), Some(to)) => body.equations.push(format!("connect({from}, {to})")),
            (Some(from), None) => body.anchor[to] = Some(from),
            (None, to) => body.anchor[from] = to,
        }
    }
    for node in 0..d.points.len() {
        let point = &d.points[node];
        let (turned, turning) = (point.angle.clone(), point.speed.clone());
        let Some(anchor) = body.anchor[node].clone() else { continue };
        body.declarations.push(format!("Real {turned} {}", quoted(&format!("angle of {}", point.name))));
        body.equations.push(format!("{turned} = {anchor}.{angle}"));
        body.declarations.push(format!("Real {turning} {}", quoted(&format!("speed of {}", point.name))));
        body.equations.push(format!("{turning} = der({turned})"));
    }
}

/// Whether a component with a flange is connected to a node.
fn is_tied(d: &Description<'_>, node: usize) -> bool {
    d.model.springs.iter().any(|spring| spring.from == node || spring.to == Some(node))
        || d.model.gears.iter().any(|gear| gear.from == node || gear.to == node)
        || d.model.bearings.iter().any(|bearing| bearing.node == node && bearing.damping.is_some())
}

fn ground(d: &Description<'_>, library: &Library, body: &mut Body, spring: usize) {
    let (name, package) = (&d.springs[spring], library.package);
    body.declarations.push(format!("{package}.Components.Fixed {name}_ground"));
    body.equations.push(format!("connect({name}.flange_b, {name}_ground.flange)"));
}
