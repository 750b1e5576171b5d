//! Rigid motion of the drivetrain, and the origin of angles.

use super::assembly::{Assembly, Class, Reference};
use crate::{Quantity, jet::Scalar};

impl Assembly<'_> {
    /// Angles are relative to a node of the drivetrain, unless a sensor, servo or spring to the ground requires absolute ones.
    pub(super) fn choose_reference(&mut self) {
        let absolute = self.model.springs.iter().any(|spring| spring.to.is_none())
            || self.model.servo.is_some()
            || self.model.outputs().any(|channel| channel.quantity == Quantity::Angle);
        let prescribed = self.groups_of(Class::Prescribed);
        let candidate = match prescribed[..] {
            [group] => Some(Reference::Driven(group)),
            [] => self.groups_of(Class::Massive).first().map(|group| Reference::Massive(*group)),
            _ => None,
        };
        if absolute {
            return;
        }
        if let Some(reference) = candidate
            && let Reference::Driven(root) | Reference::Massive(root) = reference
            && let Some(rigid) = self.rigid_mode(root)
        {
            self.reference = reference;
            self.rigid = rigid;
        }
    }

    /// Motion of each group divided by that of `root` while no spring twists. `None` if a loop of springs prevents it, or if a group is not
    /// connected to `root`.
    pub(super) fn rigid_mode(&self, root: usize) -> Option<Vec<Scalar>> {
        // With a differential, the motion of one group does not determine that of all others.
        if !self.model.differentials.is_empty() {
            return None;
        }
        let mut mode: Vec<Option<Scalar>> = vec![None; self.class.len()];
        // The frame stays where it is.
        if let Some(frame) = self.frame {
            mode[frame] = Some(Scalar::constant(0.0, self.wrt.len()));
        }
        mode[root] = Some(Scalar::constant(1.0, self.wrt.len()));
        for _ in 0..self.class.len() {
            for spring in &self.model.springs {
                let to = spring.to?;
                for (known, unknown) in [(spring.from, to), (to, spring.from)] {
                    let (Some(motion), None) = (&mode[self.group[known]], &mode[self.group[unknown]]) else {
                        continue;
                    };
                    let next = motion.times(&self.lever[known]).over(&self.lever[unknown]);
                    mode[self.group[unknown]] = Some(next);
                }
            }
        }
        let mode: Vec<Scalar> = mode.into_iter().collect::<Option<_>>()?;
        let twists = self.model.springs.iter().any(|spring| {
            let end = |node: usize| mode[self.group[node]].value * self.lever[node].value;
            spring.to.is_none_or(|to| (end(spring.from) - end(to)).abs() > 1e-9 * end(spring.from).abs())
        });
        (!twists).then_some(mode)
    }
}
