//! Inertias, springs and the time step: what has no inertia in the model must get one here, or be condensed.

use socam_model::{Quantity, Site};

use crate::{
    LeftOut,
    description::{CoordinateMotion, Description},
    error::ExportError,
};

/// A spring as a linear combination of coordinates.
#[derive(Clone)]
pub(crate) struct Link {
    pub(crate) name: String,
    pub(crate) coefficients: Vec<(usize, f64)>,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    /// Springs of the model that the link represents, each with the torque through it per torque of the link.
    pub(crate) springs: Vec<(usize, f64)>,
}

pub(crate) struct Chain {
    /// Inertia of each coordinate; `None` where it is condensed.
    pub(crate) inertia: Vec<Option<f64>>,
    pub(crate) links: Vec<Link>,
    pub(crate) time_step_s: f64,
}

/// Largest part of the shortest period or decay, in radians, that a step may be.
const STEP: f64 = 0.02;
/// Range of time steps, s.
const STEPS_S: (f64, f64) = (2e-5, 1e-3);
/// A massless node that settles faster than this, 1/s, is condensed; a slower one gets an inertia.
const SETTLES: f64 = 1e4;
/// Inertia of a slower one, as a share of damping squared over stiffness.
const SMALL: f64 = 1e-2;

impl Chain {
    pub(crate) fn of(d: &Description<'_>, left_out: &mut Vec<LeftOut>) -> Result<Self, ExportError> {
        let mut chain =
            Self { inertia: vec![None; d.coordinates.len()], links: links(d), time_step_s: STEPS_S.1 };
        let mut fastest: f64 = 0.0;
        for coordinate in 0..d.coordinates.len() {
            let (inertia, kind) = (d.inertia(coordinate), d.coordinates[coordinate].kind);
            let (stiffness, damping) = chain.held(d, coordinate);
            let name = &d.points[d.coordinates[coordinate].node].name;
            if kind == CoordinateMotion::Massive || (kind == CoordinateMotion::Prescribed && inertia > 0.0) {
                chain.inertia[coordinate] = Some(inertia);
                fastest = fastest.max((stiffness / inertia).sqrt());
                continue;
            }
            if kind == CoordinateMotion::Prescribed {
                // Any inertia: the actuator that drives it is far stiffer.
                chain.inertia[coordinate] = Some(1e-6);
                continue;
            }
            let settles = if damping > 0.0 { stiffness / damping } else { f64::INFINITY };
            if settles > SETTLES && chain.condense(d, coordinate) {
                if damping > 0.0 {
                    let why = format!(
                        "it is condensed: the springs beside it are one, which is right far below {:.3e} 1/s",
                        settles
                    );
                    left_out.push(LeftOut::new(format!("massless node {name}"), why));
                }
                continue;
            }
            let small = if damping > 0.0 { SMALL * damping * damping / stiffness.max(1e-12) } else { 0.0 };
            let least = stiffness * (STEP / STEPS_S.0 / 5.0).powi(-2);
            let given = small.max(if damping > 0.0 { 0.0 } else { least }).max(1e-12);
            chain.inertia[coordinate] = Some(given);
            fastest = fastest.max(settles.min((stiffness / given).sqrt()));
            let why = format!("MuJoCo needs an inertia there and gets {given:.3e}");
            left_out.push(LeftOut::new(format!("massless node {name}"), why));
        }
        chain.links.retain(|link| !link.coefficients.is_empty());
        if fastest > 0.0 {
            chain.time_step_s = round(STEP / fastest).clamp(STEPS_S.0, STEPS_S.1);
        }
        if chain.inertia.iter().all(Option::is_none) {
            let why = "no part of it has inertia".to_owned();
            return Err(ExportError::NoMotion { target: "MuJoCo", why });
        }
        Ok(chain)
    }

    /// Name of a coordinate's joint.
    pub(crate) fn joint(&self, d: &Description<'_>, coordinate: usize) -> String {
        d.points[d.coordinates[coordinate].node].joint.clone()
    }

    /// Stiffness and damping that hold a coordinate while the others stand still.
    fn held(&self, d: &Description<'_>, coordinate: usize) -> (f64, f64) {
        let (mut stiffness, mut damping) = (0.0, 0.0);
        for link in &self.links {
            for (own, coefficient) in &link.coefficients {
                if *own == coordinate {
                    stiffness += link.stiffness * coefficient * coefficient;
                    damping += link.damping * coefficient * coefficient;
                }
            }
        }
        for bearing in &d.model.bearings {
            let point = &d.points[bearing.node];
            if let (true, Some(own)) = (point.coordinate == coordinate, bearing.damping) {
                damping += d.value(own) * point.lever.value.powi(2);
            }
        }
        (stiffness, damping)
    }

    /// Replaces the two springs beside a coordinate on which nothing else acts by one. False where it is not so simple.
    fn condense(&mut self, d: &Description<'_>, coordinate: usize) -> bool {
        let touches = |link: &Link| link.coefficients.iter().any(|(own, _)| *own == coordinate);
        let beside: Vec<usize> = (0..self.links.len()).filter(|link| touches(&self.links[*link])).collect();
        let [a, b] = beside[..] else { return false };
        if is_loaded(d, coordinate) {
            return false;
        }
        let (b, a) = (self.links.remove(b), self.links[a].clone());
        let own = |link: &Link| {
            let found = link.coefficients.iter().find(|(own, _)| *own == coordinate);
            found.map_or(1.0, |(_, coefficient)| *coefficient)
        };
        let (of_a, of_b) = (own(&a), own(&b));
        // Twists as seen at the coordinate between: each spring takes the share of the other's stiffness.
        let (ka, kb) = (a.stiffness * of_a * of_a, b.stiffness * of_b * of_b);
        let (share_a, share_b) = (kb / (ka + kb), ka / (ka + kb));
        let damping =
            a.damping * of_a * of_a * share_a * share_a + b.damping * of_b * of_b * share_b * share_b;
        let mut coefficients: Vec<(usize, f64)> = Vec::new();
        let ends = a.coefficients.iter().map(|(c, x)| (*c, x / of_a));
        let ends = ends.chain(b.coefficients.iter().map(|(c, x)| (*c, -x / of_b)));
        for (c, x) in ends.filter(|(c, _)| *c != coordinate) {
            match coefficients.iter_mut().find(|(known, _)| *known == c) {
                Some((_, sum)) => *sum += x,
                None => coefficients.push((c, x)),
            }
        }
        let through = |links: &[(usize, f64)], factor: f64| -> Vec<(usize, f64)> {
            links.iter().map(|(spring, share)| (*spring, share * factor)).collect()
        };
        // The first coefficient is positive, as in a spring from a node to the next.
        let sign = coefficients.first().map_or(1.0, |(_, first)| first.signum());
        coefficients.iter_mut().for_each(|(_, own)| *own *= sign);
        let springs = [through(&a.springs, sign / of_a), through(&b.springs, -sign / of_b)].concat();
        let joined = Link {
            name: self.free_name(format!("{}_{}", a.name, b.name)),
            coefficients,
            stiffness: ka * kb / (ka + kb),
            damping,
            springs,
        };
        if let Some(place) = self.links.iter_mut().find(|link| link.name == a.name) {
            *place = joined;
        }
        true
    }

    /// A name that no other link has.
    fn free_name(&self, mut name: String) -> String {
        while self.links.iter().any(|link| link.name == name) {
            name.push_str("_2");
        }
        name
    }
}

fn links(d: &Description<'_>) -> Vec<Link> {
    let link = |(index, spring): (usize, &socam_model::Spring)| {
        let mut coefficients: Vec<(usize, f64)> = Vec::new();
        let ends = [(Some(spring.from), 1.0), (spring.to, -1.0)];
        for (node, sign) in ends.into_iter().filter_map(|(node, sign)| Some((node?, sign))) {
            let (coordinate, lever) = (d.points[node].coordinate, sign * d.points[node].lever.value);
            match coefficients.iter_mut().find(|(known, _)| *known == coordinate) {
                Some((_, sum)) => *sum += lever,
                None => coefficients.push((coordinate, lever)),
            }
        }
        Link {
            name: d.springs[index].clone(),
            coefficients,
            stiffness: d.value(spring.stiffness),
            damping: spring.damping.map_or(0.0, |damping| d.value(damping)),
            springs: vec![(index, 1.0)],
        }
    };
    d.model.springs.iter().enumerate().map(link).collect()
}

/// Whether anything but springs acts on a coordinate, or a sensor measures its motion.
fn is_loaded(d: &Description<'_>, coordinate: usize) -> bool {
    let model = d.model;
    let at = |node: usize| d.points[node].coordinate == coordinate;
    let bearing = model.bearings.iter().any(|bearing| at(bearing.node) && bearing.damping.is_some());
    let channel = d.inputs.iter().chain(&d.outputs).any(|signal| {
        signal.channel.quantity != Quantity::Reference && d.node(&signal.channel.at).is_some_and(at)
    });
    let effect = model.effects.iter().any(|used| match used.at {
        Site::Node(node) => at(node),
        Site::Spring(spring) | Site::Gear { contact: spring, .. } => {
            let spring = &model.springs[spring];
            at(spring.from) || spring.to.is_some_and(at)
        }
        Site::Channel(_) | Site::Servo => false,
    });
    bearing || channel || effect || model.servo.as_ref().is_some_and(|servo| at(servo.node))
}

/// One or two or five times a power of ten, not above.
fn round(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let digit = [5.0, 2.0, 1.0].into_iter().find(|digit| digit * power <= step).unwrap_or(1.0);
    // The value is the shortest decimal number, not a product with a rounding error.
    format!("{:e}", digit * power).parse::<f64>().map_or(step, |exact| (exact * 1e9).round() / 1e9)
}
