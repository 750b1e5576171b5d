//! Modelica with the Modelica Standard Library 4: a package with the drivetrain and a model that replays a recording.
//!
//! Inertias, springs, gears, dampers and sources are those of the library. The laws of effects drive `Torque` sources by equations, so that
//! they are the same as in socam.

mod components;
mod laws;

use std::fmt::Write as _;

use socam_model::{Quantity, effects::Acts};

use crate::{
    Exported, Target,
    description::{CoordinateMotion, Description},
    error::ExportError,
    formula::{Formula, MODELICA},
    header,
    names::{line, quoted},
    program::{Line, State, builder::Builder, written},
};

/// Names of the library for rotation or translation.
pub(crate) struct Library {
    pub(crate) package: &'static str,
    pub(crate) inertia: &'static str,
    pub(crate) inertia_value: &'static str,
    pub(crate) torque: &'static str,
    pub(crate) torque_value: &'static str,
    pub(crate) angle: &'static str,
}

const ROTATION: Library = Library {
    package: "Modelica.Mechanics.Rotational",
    inertia: "Inertia",
    inertia_value: "J",
    torque: "Torque",
    torque_value: "tau",
    angle: "phi",
};
const TRANSLATION: Library = Library {
    package: "Modelica.Mechanics.Translational",
    inertia: "Mass",
    inertia_value: "m",
    torque: "Force",
    torque_value: "f",
    angle: "s",
};

/// Declarations and equations of the drivetrain, as lines.
pub(crate) struct Body {
    pub(crate) declarations: Vec<String>,
    pub(crate) equations: Vec<String>,
    /// A flange of each node.
    pub(crate) anchor: Vec<Option<String>>,
}

impl Body {
    /// Ties a flange to a node.
    pub(crate) fn tie(&mut self, node: usize, flange: String) {
        match &self.anchor[node] {
            Some(anchor) => self.equations.push(format!("connect({anchor}, {flange})")),
            None => self.anchor[node] = Some(flange),
        }
    }
}

pub(crate) fn write(d: &mut Description<'_>) -> Result<Exported, ExportError> {
    let library = if d.is_rotation() { &ROTATION } else { &TRANSLATION };
    let head = header::lines(d, Target::Modelica, &[]);
    let mut body =
        Body { declarations: Vec::new(), equations: Vec::new(), anchor: vec![None; d.points.len()] };
    components::declare(d, library, &mut body);
    laws::declare(d, library, &mut body)?;
    let name = d.identifier.clone();
    let mut text = format!("package {name} {}\n", quoted(&d.model.name));
    text.push_str(&header::commented(&head, "  //"));
    let _ = write!(text, "\n  model Drivetrain {}\n", quoted(&d.model.description));
    for index in 0..d.parameters.len() {
        let own = &d.parameters[index];
        let words = header::parameter(d, index);
        let _ = writeln!(text, "    parameter Real {} = {:?} {};", own.identifier, own.value, quoted(&words));
    }
    text.extend(body.declarations.iter().map(|line| format!("    {line};\n")));
    text.push_str("  initial equation\n");
    for coordinate in &d.coordinates {
        let point = &d.points[coordinate.node];
        if coordinate.kind != CoordinateMotion::Static {
            let _ = writeln!(text, "    {} = 0;", point.angle);
        }
        if coordinate.kind == CoordinateMotion::Massive {
            let _ = writeln!(text, "    {} = 0;", point.speed);
        }
    }
    text.push_str("  equation\n");
    text.extend(body.equations.iter().map(|line| format!("    {line};\n")));
    text.push_str("  end Drivetrain;\n");
    text.push_str(&replay(d));
    if !d.is_rotation() && !d.model.gears.is_empty() {
        text.push_str(LEVER);
    }
    let _ = writeln!(text, "  annotation (uses(Modelica(version=\"4.0.0\")));\nend {name};");
    Ok(Exported { text, left_out: Vec::new() })
}

/// A ratio between two translations, which the library does not have.
const LEVER: &str = "
  model Lever \"flange_a moves ratio times as far as flange_b\"
    extends Modelica.Mechanics.Translational.Interfaces.PartialTwoFlanges;
    parameter Real ratio;
  equation
    flange_a.s = ratio*flange_b.s;
    0 = ratio*flange_a.f + flange_b.f;
  end Lever;
";

/// The drivetrain on a recording, by a table.
fn replay(d: &Description<'_>) -> String {
    let columns: Vec<&str> = d.inputs.iter().map(|signal| signal.channel.column.as_str()).collect();
    let words = format!("text file with the table `recording`: t_s, {}", columns.join(", "));
    let mut text = format!(
        "\n  model Replay \"The drivetrain on a recording\"\n    parameter String fileName = \"recording.txt\" {};\n",
        quoted(&words)
    );
    let _ = write!(
        text,
        "    Drivetrain drivetrain;\n    Modelica.Blocks.Sources.CombiTimeTable recording(tableOnFile=true, tableName=\"recording\", fileName=fileName, columns=2:{}, extrapolation=Modelica.Blocks.Types.Extrapolation.HoldLastPoint);\n  equation\n",
        d.inputs.len() + 1
    );
    for (index, signal) in d.inputs.iter().enumerate() {
        let (scale, offset) = (signal.channel.scale, signal.channel.offset);
        let _ = writeln!(
            text,
            "    drivetrain.{} = {scale:?}*recording.y[{}] + ({offset:?}); // {}",
            signal.identifier,
            index + 1,
            line(&signal.channel.name)
        );
    }
    text.push_str("  end Replay;\n\n");
    text
}
