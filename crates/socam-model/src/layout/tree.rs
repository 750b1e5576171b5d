//! A breadth-first spanning tree of a network; depths give columns, branches give lanes.

/// A spanning forest of the network.
#[derive(Debug)]
pub(super) struct Tree {
    /// Number of links from the root to each node.
    pub(super) depth: Vec<usize>,
    /// Lane of each node: a node's longest branch stays in the node's lane, each other branch gets a new one.
    pub(super) lane: Vec<usize>,
    /// Whether each node has no children.
    pub(super) is_leaf: Vec<bool>,
    /// The node that each link leads to, away from the root; `None` for a link that closes a loop.
    pub(super) child_of_link: Vec<Option<usize>>,
}

impl Tree {
    /// The tree from the node `start`; nodes that are not connected to it form further trees in lanes of their own.
    pub(super) fn grow(nodes: usize, links: &[(usize, usize)], start: usize) -> Self {
        let mut child_of_link = vec![None; links.len()];
        let mut children = vec![Vec::new(); nodes];
        let mut depth = vec![usize::MAX; nodes];
        let mut order = Vec::with_capacity(nodes);
        let mut roots = Vec::new();
        for root in std::iter::once(start).chain(0..nodes).filter(|root| *root < nodes) {
            if depth[root] != usize::MAX {
                continue;
            }
            depth[root] = 0;
            roots.push(root);
            order.push(root);
            let mut next = order.len() - 1;
            while let Some(node) = order.get(next).copied() {
                next += 1;
                for (index, (a, b)) in links.iter().enumerate().filter(|(_, (a, b))| *a == node || *b == node)
                {
                    let child = a + b - node;
                    if depth[child] == usize::MAX {
                        depth[child] = depth[node] + 1;
                        child_of_link[index] = Some(child);
                        children[node].push(child);
                        order.push(child);
                    }
                }
            }
        }

        let mut reach = vec![0_usize; nodes];
        for node in order.iter().rev() {
            reach[*node] = children[*node].iter().map(|child| reach[*child] + 1).max().unwrap_or(0);
        }
        let mut lane = vec![0; nodes];
        let mut lanes = 0;
        for root in roots {
            lane[root] = lanes;
            lanes += 1;
        }
        for node in order {
            children[node].sort_by_key(|child| std::cmp::Reverse(reach[*child]));
            for (index, child) in children[node].iter().enumerate() {
                lane[*child] = if index == 0 { lane[node] } else { lanes };
                lanes += usize::from(index > 0);
            }
        }
        let is_leaf = children.iter().map(Vec::is_empty).collect();
        Self { depth, lane, is_leaf, child_of_link }
    }
}
