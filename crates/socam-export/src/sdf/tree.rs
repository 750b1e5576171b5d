//! Tree of links: the parent of each link.

use crate::{LeftOut, description::Description, multibody::Load};

/// Part by which a link is held.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Holder {
    World,
    /// A rigid shaft to another node.
    Shaft(usize),
    /// A spring to another node.
    Spring(usize, usize),
}

pub(super) struct Tree {
    pub(super) holder: Vec<Holder>,
    /// For a root that follows another root through a gear: that one, and its own motion divided by the other's.
    pub(super) mimics: Vec<Option<(usize, f64)>>,
    /// Drag and friction of bearings at a root or at what is rigidly tied to it.
    pub(super) at_root: Vec<Load>,
    /// Stiffness of springs to the ground there.
    pub(super) to_ground: Vec<f64>,
}

impl Tree {
    pub(super) fn of(d: &Description<'_>, loads: &[Load], left_out: &mut Vec<LeftOut>) -> Self {
        let count = d.points.len();
        let mut tree = Self {
            holder: vec![Holder::World; count],
            mimics: vec![None; count],
            at_root: vec![Load::default(); count],
            to_ground: vec![0.0; count],
        };
        let mut root: Vec<Option<usize>> = vec![None; count];
        let mut used = vec![false; d.model.springs.len()];
        // Nodes at gears come first, so that gears join roots; then the nodes whose bearings drag most.
        let geared = |node: &usize| d.model.gears.iter().any(|gear| gear.from == *node || gear.to == *node);
        let drags = |node: &usize| loads[*node].damping > 0.0 || loads[*node].dry > 0.0;
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by_key(|node| (!geared(node), !drags(node), *node));
        for start in order {
            if root[start].is_none() {
                tree.grow(d, start, &mut root, &mut used);
            }
        }
        let rigid = |node: usize, root: usize, tree: &Self| -> bool {
            let mut at = node;
            while let Holder::Shaft(other) = tree.holder[at] {
                at = other;
            }
            at == root
        };
        for node in 0..count {
            let own = root[node].unwrap_or(node);
            let load = loads[node];
            if rigid(node, own, &tree) {
                tree.at_root[own].damping += load.damping;
                tree.at_root[own].dry += load.dry;
            } else if load.damping > 0.0 || load.dry > 0.0 {
                let why = "its link hangs on a spring, and SDF has no second joint for its drag and friction";
                left_out.push(LeftOut::new(format!("bearing at {}", d.points[node].name), why));
            }
        }
        for (index, spring) in d.model.springs.iter().enumerate() {
            let own = root[spring.from].unwrap_or(spring.from);
            if spring.to.is_none() && rigid(spring.from, own, &tree) {
                tree.to_ground[own] += d.value(spring.stiffness);
                tree.at_root[own].damping += spring.damping.map_or(0.0, |damping| d.value(damping));
            } else if spring.to.is_none() || !used[index] {
                let why = "it closes a loop of links, which SDF's trees do not hold";
                left_out.push(LeftOut::new(format!("spring {}", spring.name), why));
            }
        }
        for gear in &d.model.gears {
            let roots = [gear.from, gear.to].map(|node| root[node].filter(|own| rigid(node, *own, &tree)));
            match roots {
                [Some(fast), Some(slow)] if fast != slow && tree.mimics[slow].is_none() => {
                    tree.mimics[slow] = Some((fast, 1.0 / d.value(gear.ratio)));
                }
                [Some(fast), Some(slow)] if fast != slow && tree.mimics[fast].is_none() => {
                    tree.mimics[fast] = Some((slow, d.value(gear.ratio)));
                }
                _ => {
                    let why = "one of its sides hangs on a spring, so that no joint to the world can mimic the other";
                    left_out.push(LeftOut::new(format!("gear {}", gear.name), why));
                }
            }
        }
        tree
    }

    /// Hangs all nodes on `start` that springs and shafts join to it.
    fn grow(&mut self, d: &Description<'_>, start: usize, root: &mut [Option<usize>], used: &mut [bool]) {
        root[start] = Some(start);
        let mut open = std::collections::VecDeque::from([start]);
        while let Some(node) = open.pop_front() {
            for shaft in &d.model.shafts {
                let (a, b) = shaft.nodes;
                for (from, to) in [(a, b), (b, a)] {
                    if from == node && root[to].is_none() {
                        (root[to], self.holder[to]) = (Some(start), Holder::Shaft(node));
                        // Rigidly joined nodes come before nodes that springs hold.
                        open.push_front(to);
                    }
                }
            }
            for (index, spring) in d.model.springs.iter().enumerate() {
                let Some(end) = spring.to else { continue };
                for (from, to) in [(spring.from, end), (end, spring.from)] {
                    if from == node && root[to].is_none() {
                        (root[to], self.holder[to]) = (Some(start), Holder::Spring(node, index));
                        used[index] = true;
                        open.push_back(to);
                    }
                }
            }
        }
    }
}
