//! Tiles from a stored arrangement, and back.

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId};
use socam_workbench::arrangement::{Arrangement, Node, Part, SCHEMA};
use socam_workbench::derivation::Derivation;

use super::Plots;

impl Plots {
    /// The tiles in their stored form.
    pub(in crate::review) fn arrangement(&self, derived: &[Derivation]) -> Arrangement {
        Arrangement {
            schema: SCHEMA.into(),
            plots: self.tree.root.and_then(|root| self.node(root)),
            even: self.even,
            hidden: self.hidden.clone(),
            derived: derived.to_vec(),
            ..Arrangement::default()
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
