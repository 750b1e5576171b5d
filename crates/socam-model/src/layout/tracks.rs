//! Tracks of the vertical wires between two columns, so that wires of different nodes do not lie upon one another.

use super::element::{Element, ElementKind, Layout};

/// The vertical wires of one node between two columns.
struct Net {
    node: usize,
    /// Column behind the gap.
    gap: usize,
    rows: (usize, usize),
    track: usize,
}

impl Layout {
    /// The track of each joint, in their order, and for each column the number of tracks in the gap before it. Wires of one node share a
    /// track; a wire without a bend has track 0.
    ///
    /// ```
    /// use socam_model::{Model, layout::Layout};
    ///
    /// let layout = Layout::of(&Model::builtin("two-mass").expect("a chain without branches"));
    /// let (tracks, counts) = layout.tracks();
    /// assert!(tracks.iter().all(|track| *track == 0) && counts.iter().all(|count| *count == 0));
    /// ```
    #[must_use]
    pub fn tracks(&self) -> (Vec<usize>, Vec<usize>) {
        let bends = |(from, to): (&Element, &Element)| {
            from.line == to.line && from.column != to.column && from.row != to.row
        };
        let ends = |joint: usize| {
            let joint = self.joints[joint];
            (&self.elements[joint.from], &self.elements[joint.to])
        };
        let mut nets: Vec<Net> = Vec::new();
        let mut net_of = vec![None; self.joints.len()];
        for index in (0..self.joints.len()).filter(|joint| bends(ends(*joint))) {
            let (from, to) = ends(index);
            let joint = self.joints[index];
            let node = if is_node(from.kind) { joint.from } else { joint.to };
            let gap = from.column.max(to.column);
            let rows = (from.row.min(to.row), from.row.max(to.row));
            let known = nets.iter_mut().position(|net| net.node == node && net.gap == gap);
            let net = known.unwrap_or_else(|| {
                nets.push(Net { node, gap, rows, track: 0 });
                nets.len() - 1
            });
            nets[net].rows = (nets[net].rows.0.min(rows.0), nets[net].rows.1.max(rows.1));
            net_of[index] = Some(net);
        }
        let mut counts = vec![0; self.columns + 1];
        // Wires that begin lower are placed first: they then reach their track without crossing wires that began above.
        let mut order: Vec<usize> = (0..nets.len()).collect();
        order.sort_by_key(|net| std::cmp::Reverse(nets[*net].rows.0));
        for (place, index) in order.iter().copied().enumerate() {
            let own = &nets[index];
            let clashes = |track: usize| {
                order[..place].iter().map(|other| &nets[*other]).any(|other| {
                    let apart = other.rows.1 < own.rows.0 || own.rows.1 < other.rows.0;
                    other.gap == own.gap && other.track == track && !apart
                })
            };
            let track = (0..).find(|track| !clashes(*track)).unwrap_or(0);
            let count: &mut usize = &mut counts[own.gap];
            *count = (*count).max(track + 1);
            nets[index].track = track;
        }
        let tracks = net_of.into_iter().map(|net| net.map_or(0, |net| nets[net].track));
        (tracks.collect(), counts)
    }
}

fn is_node(kind: ElementKind) -> bool {
    matches!(kind, ElementKind::Motor | ElementKind::Inertia | ElementKind::Load | ElementKind::Point)
}
