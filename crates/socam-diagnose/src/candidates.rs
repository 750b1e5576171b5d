//! Every way in which an effect of the catalogue may be added to a model: where, and from which values a fit may start.

use socam_model::{
    Model, Motion,
    effects::{ActsAt, CATALOGUE, Effect, Form, REFINED, Sight},
};

use crate::{scales::Scales, score_test::A_LITTLE, selection::Path};

/// Small enough to be nothing, large enough to be divided by.
const NEXT_TO_NOTHING_S: f64 = 1e-8;
/// Stiffness of a shaft that is as good as rigid, N m/rad (N/m), and how long it may take to spring back.
const RIGID: f64 = 1e6;
const RELAXATION_S: [f64; 3] = [1e-6, 3e-3, 3e-2];

/// A shaft that may give begins so many times as stiff as the softest spring beside it, and springs back in so long.
const STIFFER: [f64; 2] = [3.0, 30.0];
const SPRINGS_BACK_S: [f64; 3] = [1e-4, 3e-3, 2e-2];

/// How far a contact may give before it slips, rad (cm).
const PRESLIDING: [f64; 3] = [1e-4, 1e-3, 1e-2];
/// Inertia that is as good as none, as a share of the least there is.
const TRIFLE: f64 = 1e-3;

/// An effect at a place with its other parameters at one point of their grid, its strength at nothing.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) effect: &'static Effect,
    pub(crate) place: String,
    /// All parameters that a file must give, SI.
    pub(crate) values: Vec<(&'static str, f64)>,
    /// Those that measure how strong it is: the model is linear in them where they are nothing.
    pub(crate) strength: &'static [&'static str],
}

impl Candidate {
    /// Whether it is a wave whose phase is not known: then its strength is that of two, a quarter of a period apart.
    pub(crate) fn is_wave(&self) -> bool {
        self.values.iter().any(|(name, _)| *name == "phase")
    }

    /// Whether the grid's points are of some strength already.
    pub(crate) fn is_full(&self) -> bool {
        matches!(self.effect.id, "coupling_slip" | "sensor_saturation")
    }

    /// What its strength is where it does nothing.
    pub(crate) fn nothing(&self) -> f64 {
        match self.effect.id {
            "sensor_gain" => 1.0,
            "missing_compliance" | "coupling_slip" | "sensor_saturation" => f64::INFINITY,
            _ => 0.0,
        }
    }

    /// Whether the other one is this effect at this place too, whatever its values.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.effect.id == other.effect.id && self.place == other.place
    }

    /// Whether it is the same and, if it comes back with every turn, as often: what does not run true has several orders.
    pub(crate) fn repeats(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|candidate| candidate.value("order"));
        self.is_same(other) && (own == others || own.is_nan())
    }

    /// Of a parameter that a file must give, SI; NaN for any other.
    pub(crate) fn value(&self, name: &str) -> f64 {
        self.values.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, value)| *value)
    }

    pub(crate) fn with(&self, name: &str, value: f64) -> Self {
        let mut changed = self.clone();
        changed.values.iter_mut().filter(|(known, _)| *known == name).for_each(|(_, old)| *old = value);
        changed
    }
}

/// All of them.
pub(crate) fn all(model: &Model, scales: &Scales) -> Vec<Candidate> {
    let mut found = Vec::new();
    // What comes back with every turn needs something that turns.
    let turns = model.motion == Motion::Rotation;
    for effect in CATALOGUE.iter().filter(|effect| turns || !is_by_turn(effect)) {
        for place in places(model, effect) {
            for start in grid(model, effect, &place, scales) {
                found.push(Candidate {
                    effect,
                    place: place.clone(),
                    values: start,
                    strength: strength(effect),
                });
            }
        }
    }
    found
}

/// Where a diagnosis looks for an effect: what acts from outside acts on the load.
fn places(model: &Model, effect: &Effect) -> Vec<String> {
    let driven: Vec<&str> = model.inputs().map(|input| input.at.as_str()).collect();
    let prescribed = |name: &str| {
        model.inputs().any(|input| input.quantity == socam_model::Quantity::Speed && input.at == name)
    };
    let mut all = model.places(effect).into_iter().filter(|place| is_part(place));
    let massive = |name: &str| inertia(model, name).is_some();
    let kept: Vec<&str> = match effect.id {
        "torque_ripple" => all.filter(|place| driven.contains(place) && !prescribed(place)).collect(),
        "missing_inertia" => all.filter(|place| !prescribed(place)).collect(),
        _ if effect.acts_at == ActsAt::Node => {
            let last = all.rfind(|place| massive(place) && !prescribed(place));
            last.into_iter().collect()
        }
        _ if effect.acts_at == ActsAt::Channel => all.filter(|place| is_sensor(model, place)).collect(),
        _ => all.collect(),
    };
    kept.into_iter().map(str::to_owned).collect()
}

/// What stands in for a mesh's teeth is no part that could be worn.
pub(crate) fn is_part(place: &str) -> bool {
    !place.ends_with(".contact")
}

fn is_sensor(model: &Model, name: &str) -> bool {
    model.channels.iter().any(|channel| channel.name == name && !channel.quantity.is_clock())
}

fn strength(effect: &Effect) -> &'static [&'static str] {
    match effect.id {
        "coulomb_friction"
        | "constant_load"
        | "hysteresis"
        | "gravity_unbalance"
        | "external_disturbance"
        | "torque_ripple" => &["torque"],
        "stribeck_friction" => &["torque", "static_torque"],
        "quadratic_drag" => &["coefficient"],
        "damping_drift" => &["rate"],
        "direction_dependence" => &["torque_difference", "damping_difference"],
        "mesh_loss" => &["fraction"],
        "backlash" => &["gap"],
        "kinematic_error" | "sensor_hum" | "sensor_ripple" => &["amplitude"],
        "stiffness_hardening" => &["cubic"],
        "missing_compliance" => &["stiffness"],
        "missing_inertia" => &["inertia"],
        "sensor_gain" => &["gain"],
        "sensor_offset" => &["offset"],
        "sensor_lag" => &["time_constant"],
        "sensor_delay" => &["delay"],
        "coupling_slip" => &["torque"],
        "sensor_saturation" => &["limit"],
        _ => &[],
    }
}

type Values = Vec<(&'static str, f64)>;

/// Points from which to look: strength at nothing, the others on a grid of what these recordings could show.
fn grid(model: &Model, effect: &Effect, place: &str, scales: &Scales) -> Vec<Values> {
    let spring = model.springs.iter().position(|spring| spring.name == place);
    let torque = spring.map_or(0.0, |spring| scales.torque(spring));
    let node = model.bearings.iter().find(|bearing| bearing.name == place).map(|bearing| bearing.node);
    let speed = node.map_or(0.0, |node| scales.speed(node));
    let output = model.outputs().position(|channel| channel.name == place);
    match effect.id {
        "stribeck_friction" => [0.02, 0.06, 0.2]
            .map(|part| {
                vec![("torque", 0.0), ("static_torque", 0.0), ("stribeck_speed", (part * speed).max(1e-3))]
            })
            .to_vec(),
        "direction_dependence" => vec![vec![("torque_difference", 0.0), ("damping_difference", 0.0)]],
        "kinematic_error" => {
            gear_orders(model, place).map(|order| wave("order", order, "amplitude")).collect()
        }
        "hysteresis" => {
            // By the file's stiffness: of two springs in a row a fit may make anything.
            let stiffness = spring.map(|spring| model.parameters[model.springs[spring].stiffness].value);
            let twist = stiffness.map_or(0.0, |stiffness| torque / stiffness);
            let deflection = |part: f64| (part * twist).max(1e-6);
            vec![vec![("torque", 0.0), ("deflection", deflection(0.3))]]
        }
        "missing_inertia" => vec![vec![("inertia", least_inertia(model, place))]],
        "missing_compliance" => RELAXATION_S
            .map(|relaxation_s| vec![("stiffness", RIGID), ("damping", RIGID * relaxation_s)])
            .to_vec(),
        "coupling_slip" => [0.9, 0.7].map(|part| vec![("torque", part * torque)]).to_vec(),
        "gravity_unbalance" => vec![vec![("torque", 0.0), ("phase", 0.0)]],
        "external_disturbance" => {
            scales.lines(None).iter().map(|hz| wave("frequency", *hz, "torque")).collect()
        }
        "torque_ripple" => (1..=12).map(|order| wave("order", f64::from(order), "torque")).collect(),
        "sensor_gain" => vec![vec![("gain", 1.0)]],
        "sensor_lag" => vec![vec![("time_constant", NEXT_TO_NOTHING_S)]],
        "sensor_delay" => vec![vec![("delay", NEXT_TO_NOTHING_S)]],
        "sensor_saturation" => {
            let limit = output.and_then(|output| scales.limit(output));
            limit.map(|limit| vec![("limit", limit)]).into_iter().collect()
        }
        "sensor_hum" => scales.lines(output).iter().map(|hz| wave("frequency", *hz, "amplitude")).collect(),
        "sensor_ripple" => (1..=12).map(|order| wave("order", f64::from(order), "amplitude")).collect(),
        _ => vec![given(effect).map(|name| (name, 0.0)).collect()],
    }
}

/// Points from which a fit is begun. How stiff a shaft is that gives, slopes at a rigid one do not say: what it adds to a twist goes
/// with the inverse of that, and a damper beside it hides it.
pub(crate) fn starts(candidate: Candidate, model: &Model, values: &[f64]) -> Vec<Candidate> {
    match candidate.effect.id {
        "missing_compliance" => {}
        // On the way from a little the mode that a mass brings crosses all others, and the fit stops at one of them.
        "missing_inertia" => {
            let foretold = candidate.with("inertia", candidate.value("inertia") / A_LITTLE);
            return vec![candidate, foretold];
        }
        _ => return vec![candidate],
    }
    let shaft = model.shafts.iter().find(|shaft| shaft.name == candidate.place);
    let is_end = |node: usize| shaft.is_some_and(|shaft| [shaft.nodes.0, shaft.nodes.1].contains(&node));
    let beside = model.springs.iter().filter(|s| is_end(s.from) || s.to.is_some_and(is_end));
    let beside = beside.map(|spring| values[spring.stiffness]);
    let softest = beside.fold(RIGID, f64::min);
    let stiffnesses = STIFFER.map(|times| times * softest);
    let each = stiffnesses.iter().flat_map(|k| SPRINGS_BACK_S.map(|relaxation_s| (*k, k * relaxation_s)));
    each.map(|(k, c)| candidate.with("stiffness", k).with("damping", c)).collect()
}

/// None where there is some already; a trifle where the model has none: a node with it moves by other equations than one without.
fn least_inertia(model: &Model, place: &str) -> f64 {
    if inertia(model, place).is_some() {
        return 0.0;
    }
    let known = model.nodes.iter().filter_map(|node| inertia(model, &node.name));
    TRIFLE * known.fold(1.0, f64::min)
}

/// Of a node, where the model has some.
pub(crate) fn inertia(model: &Model, place: &str) -> Option<f64> {
    let node = model.nodes.iter().find(|node| node.name == place)?;
    Some(model.parameters[node.inertia?].value)
}

/// A wave of no size.
fn wave(what: &'static str, value: f64, size: &'static str) -> Values {
    vec![(what, value), (size, 0.0), ("phase", 0.0)]
}

/// A few times per turn of either shaft.
fn gear_orders(model: &Model, place: &str) -> impl Iterator<Item = f64> {
    let gear = model.gears.iter().find(|gear| gear.name == place);
    let ratio = gear.map_or(1.0, |gear| model.parameters[gear.ratio].value.abs());
    let mut orders: Vec<f64> = (1..=4).map(f64::from).flat_map(|times| [times, times / ratio]).collect();
    orders.sort_by(f64::total_cmp);
    orders.dedup();
    orders.into_iter()
}

fn is_by_turn(effect: &Effect) -> bool {
    matches!(effect.id, "gravity_unbalance" | "torque_ripple" | "kinematic_error" | "sensor_ripple")
}

/// Refined laws that may stand for an effect, the simplest first, each from several points of what it has beside.
pub(crate) fn refined_laws(candidate: &Candidate, motion: Motion) -> Vec<Vec<Candidate>> {
    let has = |name: &str| candidate.values.iter().any(|(known, _)| *known == name);
    let is_it = |effect: &&&'static Effect| {
        effect.acts_at == candidate.effect.acts_at
            && given(effect).all(|name| name == "deflection" || has(name))
    };
    let start = |effect: &'static Effect, deflection: f64| {
        let value = |name| if name == "deflection" { deflection } else { candidate.value(name) };
        let values = given(effect).map(|name| (name, value(name))).collect();
        Candidate { effect, values, strength: strength(effect), ..candidate.clone() }
    };
    let laws = REFINED.iter().filter(is_it);
    let unit = if motion == Motion::Rotation { 1.0 } else { 0.01 };
    laws.map(|effect| PRESLIDING.map(|deflection| start(effect, unit * deflection)).to_vec()).collect()
}

/// Starts of a law for friction that also sticks harder than it slides, from a term that does not; and of a contact that gives before it
/// slips, as far as is known already, if it is.
pub(crate) fn richer_laws(path: &Path, term: usize) -> Vec<Candidate> {
    let own = &path.terms[term].candidate;
    let torque = path.value(term, "torque").filter(|_| own.effect.id == "coulomb_friction");
    let Some(torque) = torque else { return Vec::new() };
    let is_it = |seen: &&Candidate| seen.effect.id == "stribeck_friction" && seen.place == own.place;
    let seen = path.tests.iter().map(|one| &one.start).filter(is_it);
    let mut starts: Vec<Candidate> =
        seen.map(|start| start.with("torque", torque).with("static_torque", 1.5 * torque)).collect();
    let known = path.value(term, "deflection");
    let refined: Vec<Candidate> = starts
        .iter()
        .flat_map(|start| refined_laws(start, path.base.model.motion))
        .flatten()
        .filter(|start| start.effect.id == "stribeck_friction")
        .map(|start| known.map_or(start.clone(), |known| start.with("deflection", known)))
        .collect();
    for start in refined {
        if starts.iter().all(|other| other.values != start.values) {
            starts.push(start);
        }
    }
    starts
}

/// Whether a law holds another one of the same place as its special case.
pub(crate) fn holds(law: &Candidate, other: &Candidate) -> bool {
    law.place == other.place && law.effect.id == "stribeck_friction" && other.effect.id == "coulomb_friction"
}

/// Points of its grid from which one effect at one place is fitted.
pub(crate) fn starts_tried(candidate: &Candidate) -> usize {
    if candidate.effect.id == "stribeck_friction" { 3 } else { 1 }
}

/// Whether scores at a null amplitude say so little that it is fitted however many others stand out.
pub(crate) fn is_always_tried(candidate: &Candidate) -> bool {
    candidate.effect.id == "backlash"
}

/// Names of the parameters that a file must give.
fn given(effect: &Effect) -> impl Iterator<Item = &'static str> {
    effect.parameters.iter().filter(|own| own.default.is_none()).map(|own| own.name)
}

/// Whether an effect changes the network itself, so that it is tried in a model without others of its kind.
pub(crate) fn is_structural(effect: &Effect) -> bool {
    !matches!(effect.form, Form::Laws(_)) || effect.acts_at == ActsAt::Gear
}

/// Whether its laws see a state of their own.
pub(crate) fn has_memory(effect: &Effect) -> bool {
    matches!(effect.form, Form::Laws(laws) if laws.iter().any(|law| law.sights.contains(&Sight::State)))
}

/// Stiffness of a shaft that gives as much as a change of the rigid one's by so much.
pub(crate) fn stiffness_of(change: f64) -> f64 {
    RIGID * RIGID / change
}
