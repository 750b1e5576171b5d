//! Tiles as they are stored: nested columns, rows and tabs.

use std::collections::BTreeSet;

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId};
use serde::{Deserialize, Serialize};

use super::{Plot, Plots};
use crate::review::derived::Derivation;
use crate::review::signal::Signal;

/// What stands in a layout's file.
pub const SCHEMA: &str = "socam.layout/1";

/// A layout of the view over time: its plots, what is hidden, and its derived channels. It names channels, not recordings, and can be
/// used with others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arrangement {
    /// [`SCHEMA`].
    pub schema: String,
    /// The plots; channels without one get one below the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plots: Option<Node>,
    /// Whether all plots of a column are equally high.
    #[serde(default)]
    pub even: bool,
    /// Channels that are not drawn.
    #[serde(default)]
    pub hidden: BTreeSet<Signal>,
    /// Derived channels.
    #[serde(default)]
    pub derived: Vec<Derivation>,
}

impl Default for Arrangement {
    fn default() -> Self {
        Plots::default().arrangement(&[])
    }
}

impl Arrangement {
    /// Reads a layout.
    ///
    /// # Errors
    /// When it is none; one sentence.
    pub fn parse(value: serde_json::Value) -> Result<Self, serde_json::Error> {
        serde_json::from_value(value)
    }

    /// The file's text.
    #[must_use]
    pub fn text(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}

/// A plot, or several beside each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Node {
    /// One plot.
    Plot(Plot),
    /// Below each other.
    Column(Vec<Part>),
    /// Beside each other.
    Row(Vec<Part>),
    /// In one place, one of them in front.
    Tabs(Vec<Node>),
}

/// A part of a column or row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Its share of the height or width, relative to the other parts.
    pub share: f32,
    /// What is in it.
    pub of: Node,
}

impl Plots {
    /// The tiles as they are stored.
    pub(in crate::review) fn arrangement(&self, derived: &[Derivation]) -> Arrangement {
        Arrangement {
            schema: SCHEMA.into(),
            plots: self.tree.root.and_then(|root| self.node(root)),
            even: self.even,
            hidden: self.hidden.clone(),
            derived: derived.to_vec(),
        }
    }

    fn node(&self, id: TileId) -> Option<Node> {
        let container = match self.tree.tiles.get(id)? {
            Tile::Pane(plot) => return Some(Node::Plot(plot.clone())),
            Tile::Container(container) => container,
        };
        let Container::Linear(line) = container else {
            return Some(Node::Tabs(container.children().filter_map(|child| self.node(*child)).collect()));
        };
        // Equal heights are not stored as heights in points.
        let is_column = line.dir == LinearDir::Vertical;
        let share = |child: TileId| if is_column && self.even { 1.0 } else { line.shares[child] };
        let part = |child: &TileId| Some(Part { share: share(*child), of: self.node(*child)? });
        let parts = line.children.iter().filter_map(part).collect();
        Some(if is_column { Node::Column(parts) } else { Node::Row(parts) })
    }

    /// Tiles from a stored layout.
    pub(in crate::review) fn of(arrangement: &Arrangement) -> Self {
        let mut plots =
            Self { even: arrangement.even, hidden: arrangement.hidden.clone(), ..Self::default() };
        plots.tree.root = arrangement.plots.as_ref().map(|node| plots.tile(node));
        plots
    }

    fn tile(&mut self, node: &Node) -> TileId {
        let (dir, parts) = match node {
            Node::Plot(plot) => return self.tree.tiles.insert_pane(plot.clone()),
            Node::Tabs(nodes) => {
                let children = nodes.iter().map(|node| self.tile(node)).collect();
                return self.tree.tiles.insert_container(Tabs::new(children));
            }
            Node::Column(parts) => (LinearDir::Vertical, parts),
            Node::Row(parts) => (LinearDir::Horizontal, parts),
        };
        let children: Vec<TileId> = parts.iter().map(|part| self.tile(&part.of)).collect();
        let mut line = Linear::new(dir, children.clone());
        for (child, part) in children.into_iter().zip(parts) {
            line.shares.set_share(child, if part.share > 0.0 { part.share } else { 1.0 });
        }
        self.tree.tiles.insert_container(line)
    }
}
