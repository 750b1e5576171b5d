//! Channels: inputs that drive the machine, and measured outputs.

use socam_model::column_unit;
use socam_recording::Dataset;

use crate::{
    DescribeError,
    machine::{Channel, LinkKind, Machine, Winding},
    sizes::{Parameter, rounded},
    spec::Spec,
    words::dimension,
};

/// Columns of a recording.
pub(crate) fn columns(recording: &Dataset) -> Vec<String> {
    recording.channels().iter().map(socam_recording::Channel::column_name).collect()
}

/// The drive of a machine that swings freely.
const NOTHING: &str = "none";

impl Machine {
    /// Adds the channels.
    pub(crate) fn connect(
        &mut self,
        drives: &[String],
        measures: &[String],
        columns: Option<&[String]>,
    ) -> Result<(), DescribeError> {
        let example = self.nodes.first().map_or("motor", |node| &node.name).to_owned();
        let offer = |what: &str, quantity: &str, free: &str| {
            let list = columns.map_or(String::new(), |all| format!("; its columns are {}", all.join(", ")));
            Err(DescribeError::Machine(format!(
                "{what} is missing: say it as in {quantity}@{example}:COLUMN{free}{list}"
            )))
        };
        if drives.is_empty() {
            let quantity = if self.rotational { "torque" } else { "force" };
            return offer("what drives it", quantity, ", or as none where it swings freely");
        }
        if measures.is_empty() {
            return offer("what is measured", "speed", "");
        }
        let is_free = matches!(drives, [only] if only == NOTHING);
        for text in drives.iter().filter(|_| !is_free) {
            let spec = Spec::read(text)?;
            let channel = self.drive(&spec)?;
            self.push(&spec, channel, columns)?;
        }
        for text in measures {
            let spec = Spec::read(text)?;
            let channel = self.measure(&spec)?;
            self.push(&spec, channel, columns)?;
        }
        self.fix_inertias();
        self.fix_springs_in_series();
        Ok(())
    }

    fn node(&self, spec: &Spec<'_>) -> Result<usize, DescribeError> {
        self.nodes.iter().position(|node| node.name == spec.part).ok_or_else(|| {
            let named: Vec<&str> =
                self.nodes.iter().filter(|n| n.inertia.is_some()).map(|node| node.name.as_str()).collect();
            spec.wrong(format!("a {} is that of one of the bodies {}", spec.quantity, named.join(", ")))
        })
    }

    fn drive(&mut self, spec: &Spec<'_>) -> Result<Channel, DescribeError> {
        let input = |quantity: &'static str, at: &str| Channel {
            is_input: true,
            quantity,
            at: at.to_owned(),
            ..Channel::default()
        };
        match spec.quantity {
            "torque" | "force" => {
                let node = self.node(spec)?;
                let constant = self.nodes[node].body.torque_constant.clone();
                let mut channel = input(self.effort(), spec.part);
                let reads_current = spec.column.as_deref().and_then(column_unit) == Some("A");
                if let Some(constant) = constant.filter(|_| reads_current && spec.scale.is_none()) {
                    channel.scale = Some(constant.si);
                    channel.remark =
                        format!("the motor's torque constant, {} {}", constant.value, constant.unit);
                }
                Ok(channel)
            }
            "current" => {
                let node = self.node(spec)?;
                let constant = self.nodes[node].body.torque_constant.as_ref().map(|constant| constant.si);
                let Some(scale) = spec.scale.or(constant) else {
                    return Err(spec.wrong("how many N m is one A? write the torque constant at the motor (motor 0.055Nm/A) or behind the column (*0.055)"));
                };
                let remark = "torque per A".to_owned();
                Ok(Channel { scale: Some(scale), remark, ..input(self.effort(), spec.part) })
            }
            "voltage" => {
                let node = self.node(spec)?;
                let name = format!("{}_winding", self.nodes[node].name);
                self.wind(node, &name);
                Ok(input("voltage", &name))
            }
            "speed" => {
                self.node(spec)?;
                let is_angle = spec
                    .column
                    .as_deref()
                    .and_then(column_unit)
                    .is_some_and(|unit| matches!(unit, "rad" | "m"));
                Ok(Channel { take_rate: is_angle, ..input("speed", spec.part) })
            }
            "position" | "angle" | "reference" => {
                self.servo = Some(self.node(spec)?);
                Ok(input("reference", "servo"))
            }
            other => Err(spec.wrong(format!(
                "\"{other}\" drives nothing; write torque, force, current, voltage, speed or position"
            ))),
        }
    }

    fn effort(&self) -> &'static str {
        if self.rotational { "torque" } else { "force" }
    }

    /// Adds the winding of a motor.
    fn wind(&mut self, node: usize, name: &str) {
        let body = &self.nodes[node].body;
        let given = |size: &Option<crate::words::Size>| size.as_ref().map(Parameter::given);
        self.winding = Some(Winding {
            node,
            name: name.to_owned(),
            resistance: given(&body.resistance)
                .unwrap_or_else(|| Parameter::usual(1.0, "ohm", 0.05, 20.0, "servo motors")),
            torque_constant: given(&body.torque_constant)
                .unwrap_or_else(|| Parameter::usual(0.1, "N m/A", 0.005, 2.0, "servo motors")),
            inductance: given(&body.inductance),
        });
    }

    fn measure(&self, spec: &Spec<'_>) -> Result<Channel, DescribeError> {
        let output =
            |quantity: &'static str| Channel { quantity, at: spec.part.to_owned(), ..Channel::default() };
        match spec.quantity {
            "speed" => self.node(spec).map(|_| output("speed")),
            "angle" | "position" => {
                self.node(spec).map(|_| output(if self.rotational { "angle" } else { "position" }))
            }
            "acceleration" => self.node(spec).map(|_| output("acceleration")),
            "torque" | "force" => {
                let springs = self.links.iter().filter(|link| matches!(link.kind, LinkKind::Spring { .. }));
                let mut names: Vec<&str> = springs.map(|link| link.name.as_str()).collect();
                names.extend(self.servo.map(|_| "servo"));
                if names.contains(&spec.part) {
                    return Ok(output(self.effort()));
                }
                let there = if names.is_empty() { "none, so add a sensor".to_owned() } else { names.join(", ") };
                Err(spec.wrong(format!("a torque is measured in an elastic part: {there}")))
            }
            "current" => match &self.winding {
                Some(winding) if self.nodes[winding.node].name == spec.part => {
                    Ok(Channel { at: winding.name.clone(), ..output("current") })
                }
                _ => Err(spec.wrong(
                    "a current is predicted only of a motor that a voltage drives; as the drive write current@motor:COLUMN",
                )),
            },
            other => Err(spec.wrong(format!(
                "\"{other}\" is not measured; write speed, angle, position, acceleration, torque or current"
            ))),
        }
    }

    fn push(
        &mut self,
        spec: &Spec<'_>,
        mut channel: Channel,
        columns: Option<&[String]>,
    ) -> Result<(), DescribeError> {
        let name = format!(
            "{}_{}",
            spec.part,
            if spec.quantity == "reference" { "position" } else { spec.quantity }
        );
        let is_taken = |name: &String| self.channels.iter().any(|channel| channel.name == *name);
        let numbered = (2..).map(|number| format!("{name}_{number}"));
        channel.name =
            std::iter::once(name.clone()).chain(numbered).find(|name| !is_taken(name)).unwrap_or(name);
        // Behind a screw a travel of 1 m is this angle.
        let node = self.nodes.iter().find(|node| node.name == spec.part);
        let rad_per_m = node.and_then(|node| node.lead_m).map(|lead_m| std::f64::consts::TAU / lead_m);
        let (suffix, linear) = suffixes(channel.quantity, self.rotational);
        let suffix = if rad_per_m.is_some() && linear != suffix { linear } else { suffix };
        channel.column = match (&spec.column, columns) {
            (Some(column), Some(columns)) if !columns.contains(column) => {
                let list = columns.join(", ");
                return Err(spec.wrong(format!("the recording has no column \"{column}\"; it has {list}")));
            }
            (Some(column), _) => Some(column.clone()),
            (None, Some(columns)) => Some(self.choose(spec, suffix, columns)?),
            (None, None) if spec.unit.is_some() => Some(format!("{}_1", channel.name)),
            (None, None) => {
                Some(format!("{}{}", channel.name, if channel.scale.is_some() { "_A" } else { suffix }))
            }
        };
        let own = channel.column.as_deref().and_then(column_unit);
        if channel.quantity == "torque" && own == Some("A") && spec.scale.or(channel.scale).is_none() {
            return Err(spec.wrong("how many N m is one A? write the torque constant behind the column (*0.055), or at the motor (motor 0.055Nm/A)"));
        }
        let is_linear = |unit: &str| {
            let lengths = dimension(unit)[1];
            lengths == 1 && dimension(unit)[0] == 0
        };
        let measured = spec.unit.as_deref().or(own);
        let travel = rad_per_m.filter(|_| measured.is_some_and(is_linear));
        let factor = spec.unit.as_deref().and_then(socam_units::parse).map_or(1.0, |unit| unit.factor);
        if channel.scale.is_none() {
            channel.scale = spec.scale;
        }
        match travel {
            Some(travel) => {
                channel.scale = Some(rounded_scale(travel * factor * channel.scale.unwrap_or(1.0)));
                channel.remark = "rad per m of travel: 2 pi/lead".into();
            }
            None => channel.unit.clone_from(&spec.unit),
        }
        self.channels.push(channel);
        Ok(())
    }

    /// The column of a recording that a channel without a column reads: the only one with its unit, or the only one of these with the
    /// part's name in it.
    fn choose(&self, spec: &Spec<'_>, suffix: &str, columns: &[String]) -> Result<String, DescribeError> {
        let is_free = |column: &&String| !self.channels.iter().any(|c| c.column.as_ref() == Some(*column));
        let wanted = column_unit(&format!("x{suffix}"));
        let fits: Vec<&String> =
            columns.iter().filter(|column| column_unit(column) == wanted).filter(is_free).collect();
        let named: Vec<&String> = fits.iter().copied().filter(|column| column.contains(spec.part)).collect();
        match (&fits[..], &named[..]) {
            ([only], _) | (_, [only]) => Ok((*only).clone()),
            _ => {
                let all = if fits.is_empty() { columns.iter().collect() } else { fits };
                let list = all.iter().map(|column| column.as_str()).collect::<Vec<_>>().join(", ");
                Err(spec.wrong(format!(
                    "which column is it? write {}@{}:COLUMN, where COLUMN is one of {list}",
                    spec.quantity, spec.part
                )))
            }
        }
    }
}

/// Suffix of a quantity's columns in this machine, and where it is measured along a travel.
fn suffixes(quantity: &str, rotational: bool) -> (&'static str, &'static str) {
    match (quantity, rotational) {
        ("speed", true) => ("_rad_s", "_m_s"),
        ("speed", false) => ("_m_s", "_m_s"),
        ("acceleration", true) => ("_rad_s2", "_m_s2"),
        ("acceleration", false) => ("_m_s2", "_m_s2"),
        ("torque", _) => ("_Nm", "_Nm"),
        ("force", _) => ("_N", "_N"),
        ("voltage", _) => ("_V", "_V"),
        ("current", _) => ("_A", "_A"),
        (_, true) => ("_rad", "_m"),
        (_, false) => ("_m", "_m"),
    }
}

/// A factor to seven digits.
fn rounded_scale(scale: f64) -> f64 {
    if (rounded(scale) - scale).abs() < 1e-9 * scale.abs() {
        return rounded(scale);
    }
    format!("{scale:.6e}").parse().unwrap_or(scale)
}
