//! Fixes what no recording of a chain can tell apart.

use crate::{
    machine::{LinkKind, Machine},
    sizes::Trust,
};

impl Machine {
    /// Fixes stiffnesses that no recording can tell apart: of springs in series without an inertia between them, the one that is known
    /// least stays free.
    pub(crate) fn fix_springs_in_series(&mut self) {
        // The links of a chain are in its order: link n leads to node n + 1.
        let mut series: Vec<Vec<usize>> = vec![Vec::new()];
        for (index, link) in self.links.iter().enumerate() {
            if let (LinkKind::Spring { .. }, Some(run)) = (&link.kind, series.last_mut()) {
                run.push(index);
            }
            if self.nodes[link.to].inertia.is_some() {
                series.push(Vec::new());
            }
        }
        for run in series.into_iter().filter(|run| run.len() > 1) {
            let trust = |link: &usize| match &self.links[*link].kind {
                LinkKind::Spring { stiffness, .. } => stiffness.trust,
                _ => Trust::Given,
            };
            let Some(free) = run.iter().copied().min_by_key(trust) else { continue };
            let free_name = self.links[free].name.clone();
            for link in run.into_iter().filter(|link| *link != free) {
                let LinkKind::Spring { stiffness, damping } = &mut self.links[link].kind else { continue };
                for parameter in [stiffness, damping] {
                    parameter.fixed = true;
                    parameter.source += &format!("; fixed: recordings show only the series with {free_name}");
                }
            }
        }
    }

    /// Fixes inertias that no recording can tell apart: in each rigid group the one that is known least stays free, and none where the
    /// group's speed is an input.
    pub(crate) fn fix_inertias(&mut self) {
        let groups = self.rigid_groups();
        let prescribed = self.prescribed_group();
        for group in 0..self.nodes.len() {
            let members: Vec<usize> = (0..groups.len())
                .filter(|n| groups[*n] == group && self.nodes[*n].inertia.is_some())
                .collect();
            let trust =
                |node: &usize| self.nodes[*node].inertia.as_ref().map_or(Trust::Given, |own| own.trust);
            let free = members.iter().rev().min_by_key(|node| trust(node)).copied();
            let free_name = free.map(|node| self.nodes[node].name.clone()).unwrap_or_default();
            for node in members {
                let is_free = Some(node) == free && Some(group) != prescribed;
                let Some(inertia) = self.nodes[node].inertia.as_mut().filter(|_| !is_free) else { continue };
                inertia.fixed = true;
                let why = if Some(group) == prescribed {
                    "its speed is an input, so that no recording shows it".to_owned()
                } else {
                    format!("recordings show only the sum with {free_name}")
                };
                inertia.source += &format!("; fixed: {why}");
            }
        }
    }
}
