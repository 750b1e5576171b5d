//! Groups of nodes that rigid gears and shafts join: each group has one coordinate.

use crate::{Model, ModelError, jet::Scalar};

/// The group of each node, its lever (motion of the node divided by that of the group), and the number of groups.
pub(super) fn tie_nodes(
    model: &Model,
    values: &[f64],
    wrt: &[usize],
) -> Result<(Vec<usize>, Vec<Scalar>, usize), ModelError> {
    let unity = Scalar::constant(1.0, wrt.len());
    let shafts = model.shafts.iter().map(|shaft| (&shaft.name, shaft.nodes.0, shaft.nodes.1, unity.clone()));
    let gears = model
        .gears
        .iter()
        .map(|gear| (&gear.name, gear.from, gear.to, Scalar::parameter(values, wrt, gear.ratio)));
    let mut group: Vec<usize> = (0..model.nodes.len()).collect();
    let mut lever = vec![unity.clone(); model.nodes.len()];
    for (name, from, to, ratio) in shafts.chain(gears) {
        if group[from] == group[to] {
            return Err(ModelError::Network(format!(
                "{name} closes a rigid loop: its two nodes are tied already"
            )));
        }
        // Every member of the `to` group now moves with the `from` group.
        let factor = lever[from].over(&ratio).over(&lever[to]);
        let joined = group[to];
        for node in (0..model.nodes.len()).filter(|node| group[*node] == joined).collect::<Vec<_>>() {
            group[node] = group[from];
            lever[node] = lever[node].times(&factor);
        }
    }
    let mut names = group.clone();
    names.sort_unstable();
    names.dedup();
    let group = group.iter().map(|g| names.partition_point(|name| name < g)).collect();
    Ok((group, lever, names.len()))
}
