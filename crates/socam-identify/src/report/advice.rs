//! Advice: sensors and experiments that would determine the parameters that the data do not determine.

use socam_model::{Model, Spring};

use crate::{
    report::{ParameterEstimate, Source},
    uncertainty::combinations,
};

/// One sentence per reason why parameters are not determined.
pub(crate) fn advice(model: &Model, estimates: &[ParameterEstimate]) -> Vec<String> {
    let mut open: Vec<usize> = (0..estimates.len())
        .filter(|index| !estimates[*index].identifiable && estimates[*index].source != Source::Fixed)
        .collect();
    let mut sentences: Vec<String> = Vec::new();
    for (a, b) in combinations::pairs(model) {
        let (own, rest): (Vec<usize>, Vec<usize>) =
            open.iter().partition(|index| belongs(a, **index) || belongs(b, **index));
        let stiffnesses = own.iter().any(|index| *index == a.stiffness || *index == b.stiffness);
        if stiffnesses {
            sentences.push(in_series(model, a, b, &own));
            open = rest;
        }
    }
    for role in Role::ALL {
        let own: Vec<usize> = open.iter().copied().filter(|index| Role::of(model, *index) == role).collect();
        if !own.is_empty() {
            sentences.push(format!("{}: {}.", names(model, &own), role.remedy()));
        }
    }
    sentences
}

fn belongs(spring: &Spring, index: usize) -> bool {
    spring.stiffness == index || spring.damping == Some(index)
}

fn names(model: &Model, parameters: &[usize]) -> String {
    let names: Vec<&str> = parameters.iter().map(|index| model.parameters[*index].name.as_str()).collect();
    names.join(", ")
}

fn in_series(model: &Model, a: &Spring, b: &Spring, own: &[usize]) -> String {
    let ends = |spring: &Spring| [Some(spring.from), spring.to];
    let shared = ends(a).into_iter().flatten().find(|node| ends(b).contains(&Some(*node)));
    let between = shared.map_or("between them", |node| model.nodes[node].name.as_str());
    format!(
        "{}: {} and {} are springs in series, of which only the combined stiffness is determined; an angle sensor at {between}, or the value of one of them, fixed to that of a torsion test, would tell them apart.",
        names(model, own),
        a.name,
        b.name
    )
}

/// Role of a parameter in the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    Stiffness,
    SpringDamping,
    Inertia,
    Bearing,
    Effect,
    Other,
}

impl Role {
    const ALL: [Self; 6] =
        [Self::Stiffness, Self::SpringDamping, Self::Inertia, Self::Bearing, Self::Effect, Self::Other];

    fn of(model: &Model, index: usize) -> Self {
        if model.springs.iter().any(|spring| spring.stiffness == index) {
            Self::Stiffness
        } else if model.springs.iter().any(|spring| spring.damping == Some(index)) {
            Self::SpringDamping
        } else if model.nodes.iter().any(|node| node.inertia == Some(index)) {
            Self::Inertia
        } else if model.bearings.iter().any(|bearing| bearing.damping == Some(index)) {
            Self::Bearing
        } else if model.effects.iter().any(|used| used.parameters.contains(&index)) {
            Self::Effect
        } else {
            Self::Other
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Self::Stiffness => {
                "record a chirp or prbs that reaches the resonance it makes, or a torque sensor beside it"
            }
            Self::SpringDamping => "record a chirp or prbs that lingers at the resonance it damps",
            Self::Inertia => "record fast accelerations (prbs, reversals), or fix it to its drawing's value",
            Self::Bearing => {
                "record several steady speeds in both directions, with the driving torque measured"
            }
            Self::Effect => "record slow passes through standstill in both directions",
            Self::Other => "fix it to a value known from elsewhere, or add a sensor beside it",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(name: &str, identifiable: bool, source: Source) -> ParameterEstimate {
        ParameterEstimate {
            name: name.into(),
            value: None,
            unit: String::new(),
            std: None,
            ci95: [None, None],
            identifiable,
            source,
            determined_with: Vec::new(),
            note: String::new(),
        }
    }

    #[test]
    fn each_open_parameter_is_named_once() {
        let model = Model::builtin("speed-o-cam").unwrap();
        let open = ["k1", "k2", "c2", "k4"];
        let estimates: Vec<_> = model
            .parameters
            .iter()
            .map(|known| {
                let source = if known.fixed { Source::Fixed } else { Source::Data };
                estimate(&known.name, !open.contains(&known.name.as_str()), source)
            })
            .collect();
        let said = advice(&model, &estimates);
        for name in open {
            let here =
                said.iter().filter(|line| line.split([',', ':', ' ']).any(|word| word == name)).count();
            assert_eq!(here, 1, "{name} in {said:?}");
        }
        assert!(said[0].starts_with("k1, k2, c2: ") && said[0].contains("in series"), "{said:?}");
        let settled: Vec<_> =
            estimates.into_iter().map(|one| ParameterEstimate { identifiable: true, ..one }).collect();
        assert_eq!(advice(&model, &settled), [""; 0]);
    }
}
