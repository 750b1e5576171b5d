//! Refuses networks with parts that no input reaches and springs that cannot twist. Networks that are probably mistakes but have
//! equations give [`Model::warnings`](crate::Model::warnings).

use super::reader::Reader;
use crate::{Model, ModelError, Site};

impl Reader<'_> {
    pub(super) fn check_wiring(&self, model: &Model) -> Result<(), ModelError> {
        self.check_springs(model)?;
        self.check_reach(model)
    }

    /// Refuses a spring between two nodes that rigid shafts join, which never twists.
    fn check_springs(&self, model: &Model) -> Result<(), ModelError> {
        let shafts: Vec<(usize, usize)> = model.shafts.iter().map(|shaft| shaft.nodes).collect();
        let part = parts(model.nodes.len(), &shafts);
        for spring in &model.springs {
            let Some(to) = spring.to else { continue };
            if spring.from != to && part[spring.from] == part[to] {
                let [from, to] = [spring.from, to].map(|node| &model.nodes[node].name);
                return self.fail_in(
                    self.line_of_place(&spring.name),
                    format!(
                        "spring \"{}\" can never twist: rigid shafts join its nodes \"{from}\" and \"{to}\"; tie it to another node, or remove the shaft",
                        spring.name
                    ),
                );
            }
        }
        Ok(())
    }

    /// Refuses nodes that are not connected to a node on which an input or effect acts, in a model that has inputs. One without any swings
    /// freely.
    fn check_reach(&self, model: &Model) -> Result<(), ModelError> {
        if !model.inputs().any(|input| input.quantity.drives()) {
            return Ok(());
        }
        let springs = model.springs.iter().filter_map(|spring| Some((spring.from, spring.to?)));
        let gears = model.gears.iter().map(|gear| (gear.from, gear.to));
        let mixed = model.differentials.iter().flat_map(|d| d.from.map(|from| (from, d.to)));
        let links: Vec<(usize, usize)> =
            springs.chain(gears).chain(mixed).chain(model.shafts.iter().map(|shaft| shaft.nodes)).collect();
        let part = parts(model.nodes.len(), &links);
        let node_at = |place: &str| {
            let node = model.nodes.iter().position(|node| node.name == place);
            let spring =
                || model.springs.iter().find(|spring| spring.name == place).map(|spring| spring.from);
            let servo = || model.servo.as_ref().filter(|servo| servo.name == place).map(|servo| servo.node);
            let motor = || model.motors.iter().find(|motor| motor.name == place).map(|motor| motor.node);
            node.or_else(spring).or_else(servo).or_else(motor)
        };
        let driven = model.inputs().filter(|input| input.quantity.drives());
        let driven = driven.filter_map(|input| node_at(&input.at));
        let pushed = model.effects.iter().filter_map(|used| match used.at {
            Site::Node(node) => Some(node),
            _ => None,
        });
        let reached: Vec<usize> = driven.chain(pushed).map(|node| part[node]).collect();
        let Some(adrift) = (0..part.len()).find(|node| !reached.contains(&part[*node])) else {
            return Ok(());
        };
        let together: Vec<&str> = (0..part.len())
            .filter(|node| part[*node] == part[adrift])
            .map(|node| model.nodes[node].name.as_str())
            .collect();
        let measured =
            model.outputs().find(|output| node_at(&output.at).is_some_and(|node| part[node] == part[adrift]));
        let sensor =
            measured.map_or(String::new(), |output| format!(", where channel {} measures", output.name));
        self.fail_in(
            self.line_of_place(&model.nodes[adrift].name),
            format!(
                "nothing drives {}{sensor}: no spring, gear or shaft joins it to a place that has an input; join it, or remove it",
                together.join(", ")
            ),
        )
    }

    fn line_of_place(&self, name: &str) -> usize {
        self.places.iter().find(|(place, _)| place == name).map_or(1, |(_, line)| *line)
    }
}

/// Number of the part of the network that each node belongs to.
fn parts(nodes: usize, links: &[(usize, usize)]) -> Vec<usize> {
    let mut neighbours = vec![Vec::new(); nodes];
    for (a, b) in links {
        neighbours[*a].push(*b);
        neighbours[*b].push(*a);
    }
    let mut part = vec![usize::MAX; nodes];
    for root in 0..nodes {
        let mut open = vec![root];
        while let Some(node) = open.pop() {
            if part[node] == usize::MAX {
                part[node] = root;
                open.extend(&neighbours[node]);
            }
        }
    }
    part
}
