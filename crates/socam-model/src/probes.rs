//! Outputs that are added to a model to see the motion of all its nodes and the torque in all its springs.

use toml_edit::{Item, Table, value};

use crate::{
    Model, ModelError, Quantity,
    edit::{fault, parsed},
    effects,
};

/// An output that was added to a model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Probe {
    /// Name of its channel.
    pub channel: String,
    /// [`Quantity::Speed`] of a node (rad/s, m/s) or [`Quantity::Torque`] of a spring (N m, N).
    pub quantity: Quantity,
    /// The node or spring.
    pub at: String,
}

impl Model {
    /// The model with an output for the speed of each node and the torque of each spring, to be simulated and drawn. Its equations of motion
    /// are the same. A place at which no output can be is left out.
    ///
    /// ```
    /// use socam_model::{Model, Quantity};
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// let (seen, probes) = model.with_probes()?;
    /// assert_eq!(probes.iter().map(|probe| probe.at.as_str()).collect::<Vec<_>>(), ["motor", "load", "shaft"]);
    /// assert_eq!(probes[2].quantity, Quantity::Torque);
    /// assert_eq!(seen.outputs().count(), model.outputs().count() + 3);
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::File`] where [`Model::text`] is not TOML.
    pub fn with_probes(&self) -> Result<(Self, Vec<Probe>), ModelError> {
        let nodes = self.nodes.iter().map(|node| (Quantity::Speed, &node.name));
        let parts = self.springs.iter().filter(|spring| effects::is_part(&spring.name));
        let springs = parts.map(|spring| (Quantity::Torque, &spring.name));
        let (mut seen, mut probes) = (self.clone(), Vec::new());
        for (quantity, at) in nodes.chain(springs) {
            let number = (probes.len() + 1..)
                .find(|number| self.channels.iter().all(|channel| channel.name != format!("probe_{number}")));
            let channel = format!("probe_{}", number.unwrap_or_default());
            let text = add_output(&seen.text, &channel, quantity, at)?;
            let works = |grown: &Self| grown.equations(&grown.values()).is_ok();
            if let Some(grown) = Self::parse(&text).ok().filter(works) {
                seen = grown;
                probes.push(Probe { channel, quantity, at: at.clone() });
            }
        }
        seen.keep_parameters(self);
        Ok((seen, probes))
    }
}

fn add_output(text: &str, channel: &str, quantity: Quantity, at: &str) -> Result<String, ModelError> {
    let mut document = parsed(text)?;
    let mut table = Table::new();
    table.insert("role", value("output"));
    table.insert("quantity", value(if quantity == Quantity::Torque { "torque" } else { "speed" }));
    table.insert("at", value(at));
    let channels = document.entry("channels").or_insert(Item::Table(Table::new()));
    let channels = channels.as_table_like_mut().ok_or_else(|| fault("channels must be tables".into()))?;
    channels.insert(channel, Item::Table(table));
    Ok(document.to_string())
}
