//! Groups of nodes that rigid gears and shafts join: each group has one coordinate, unless a differential moves it.

use crate::{
    Model, ModelError,
    jet::{Jet, Scalar},
};

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
                "{name} closes a rigid loop: its two nodes are tied already; remove it, or join one of them by a spring"
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

/// The motion of each group as a row over all groups: its own coordinate, or, if a differential moves the group, the motions of the groups
/// that move it.
pub(super) fn mix_groups(
    model: &Model,
    values: &[f64],
    wrt: &[usize],
    (group, lever, groups): (&[usize], &[Scalar], usize),
) -> Result<Vec<Jet>, ModelError> {
    let unity = Scalar::constant(1.0, wrt.len());
    let own = |index: usize| {
        let mut row = Jet::zeros(1, groups, wrt.len());
        row.add_at(0, index, &unity);
        row
    };
    let mut rows: Vec<Jet> = (0..groups).map(own).collect();
    for differential in &model.differentials {
        let moved = group[differential.to];
        let mut row = Jet::zeros(1, groups, wrt.len());
        for (from, factor) in differential.from.into_iter().zip(differential.factors) {
            let factor = Scalar::parameter(values, wrt, factor).times(&lever[from]);
            row = row.plus(&rows[group[from]].scaled(&factor.over(&lever[differential.to])));
        }
        let is_free = rows[moved].value[(0, moved)] == 1.0;
        if !is_free || row.value[(0, moved)] != 0.0 {
            return Err(ModelError::Network(format!(
                "{} closes a rigid loop: {} is tied to its two other nodes already; remove a tie, or replace it by a spring",
                differential.name, model.nodes[differential.to].name
            )));
        }
        for known in &mut rows {
            let share = known.at(0, moved);
            let mut without = known.clone();
            without.add_at(0, moved, &share.times(&Scalar::constant(-1.0, wrt.len())));
            *known = without.plus(&row.scaled(&share));
        }
    }
    Ok(rows)
}
