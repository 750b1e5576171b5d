//! Misfit without a name: which place's unknown torque, or which channel's error, would carry it, and its shape.
//!
//! At every place a torque is let free that is any smooth function of one thing: the place's speed, its angle within a turn, a
//! coupling's twist, or time; or a drag against the motion is one of time or of the angle, or a coupling's stiffness one of time.
//! One evaluation with sensitivities says what each would gain and what it would look like.

use rayon::prelude::*;
use socam_identify::{
    IdentifyError,
    comparison::{self, CandidateScore, NoiseModel},
};
use socam_model::{
    Model, ModelError, Motion,
    effects::{
        Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, LawInput, MAX_LAW_INPUTS, MAX_PARAMETERS,
        Response, TRANSITION_SPEED,
    },
};
use socam_recording::Dataset;

use crate::{
    candidates::{Candidate, is_part},
    choice::Choice,
    context::{Context, FittedModel},
    criterion::{self, Difference},
    document::{Curve, Over},
    scales::Scales,
    score_test::{self, carried, estimated},
    selection::{EXCESS, Path},
};

/// Points that a curve is made of.
const POINTS: usize = 9;
/// Curves that share a pass: each adds its points to what a step costs.
const TOGETHER: usize = 3;
/// Orders of a curve over one turn.
const ORDERS: usize = 4;
/// Name of the speed within which what rubs turns its direction: as wide as that of the catalogue's friction.
const TRANSITION: &str = "transition_speed";
/// How much more than its scores promise a curve may gain at most.
const BEYOND_PROMISE: f64 = 1.5;
/// Iterations of a shape's fit.
const ITERATIONS: usize = 10;
const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// A hump of a height about a centre, nothing beyond a width on either side: such humps side by side make any smooth curve.
const HUMP: &[EffectParameter] = &[
    EffectParameter { name: "height", kind: Kind::Gain, default: None, bounds: ANY },
    EffectParameter { name: "centre", kind: Kind::Gain, default: None, bounds: ANY },
    EffectParameter { name: "width", kind: Kind::Gain, default: None, bounds: ANY },
];

/// The same of what rubs: it turns with the motion, within so much speed.
const RUB: &[EffectParameter] = &[HUMP[0], HUMP[1], HUMP[2], EffectParameter { name: TRANSITION, ..HUMP[2] }];

fn hump(law_inputs: &[f64], p: &[f64]) -> Response {
    let distance = (law_inputs[0] - p[1]) / p[2];
    let (mut derivatives, mut by_parameter) = ([0.0; MAX_LAW_INPUTS], [0.0; MAX_PARAMETERS]);
    if distance.abs() >= 1.0 {
        return Response { torque: 0.0, derivatives, by_parameter };
    }
    let (sin, cos) = (std::f64::consts::PI * distance).sin_cos();
    let value = 0.5 * (1.0 + cos);
    derivatives[0] = -0.5 * std::f64::consts::PI * sin / p[2] * p[0];
    by_parameter[0] = value;
    Response { torque: p[0] * value, derivatives, by_parameter }
}

/// One wave per turn of a whole number, or its quarter.
fn wave(law_inputs: &[f64], p: &[f64]) -> Response {
    let (sin, cos) = (p[1] * law_inputs[0] + p[2]).sin_cos();
    let (mut derivatives, mut by_parameter) = ([0.0; MAX_LAW_INPUTS], [0.0; MAX_PARAMETERS]);
    derivatives[0] = p[0] * p[1] * cos;
    by_parameter[0] = sin;
    Response { torque: p[0] * sin, derivatives, by_parameter }
}

/// So much of what is read, or of a twist, by time.
fn swelling(law_inputs: &[f64], p: &[f64]) -> Response {
    let Response { torque, derivatives: by_time, by_parameter } = hump(&law_inputs[1..], p);
    let mut derivatives = [0.0; MAX_LAW_INPUTS];
    derivatives[..2].copy_from_slice(&[torque, law_inputs[0] * by_time[0]]);
    Response {
        torque: law_inputs[0] * torque,
        derivatives,
        by_parameter: by_parameter.map(|derivative| law_inputs[0] * derivative),
    }
}

fn against(law_inputs: &[f64], p: &[f64]) -> Response {
    turned(hump(law_inputs, p))
}

fn wave_against(law_inputs: &[f64], p: &[f64]) -> Response {
    turned(wave(law_inputs, p))
}

/// Against the motion, by time or angle.
fn rubbing(law_inputs: &[f64], p: &[f64], shape: fn(&[f64], &[f64]) -> Response) -> Response {
    let Response { torque, derivatives: by_other, by_parameter } = shape(&law_inputs[1..], p);
    let sign = (law_inputs[0] / p[3]).tanh();
    let mut derivatives = [0.0; MAX_LAW_INPUTS];
    derivatives[..2].copy_from_slice(&[-torque * (1.0 - sign * sign) / p[3], -sign * by_other[0]]);
    Response {
        torque: -sign * torque,
        derivatives,
        by_parameter: by_parameter.map(|derivative| -sign * derivative),
    }
}

fn hump_rubs(law_inputs: &[f64], p: &[f64]) -> Response {
    rubbing(law_inputs, p, hump)
}

fn wave_rubs(law_inputs: &[f64], p: &[f64]) -> Response {
    rubbing(law_inputs, p, wave)
}

/// Of a bearing the torque that it takes is drawn, not the one that it gives.
fn turned(response: Response) -> Response {
    Response {
        torque: -response.torque,
        derivatives: response.derivatives.map(|derivative| -derivative),
        by_parameter: response.by_parameter.map(|derivative| -derivative),
    }
}

const fn shape(acts_at: ActsAt, laws: &'static [Law]) -> Effect {
    Effect::bare("shape", acts_at, HUMP, None, Form::Laws(laws), "")
}

const fn rub(law_inputs: &'static [LawInput], evaluate: fn(&[f64], &[f64]) -> Response) -> Law {
    Law { transition: |parameters| parameters[3], ..law(law_inputs, Acts::Torque, evaluate) }
}

const fn law(law_inputs: &'static [LawInput], acts: Acts, evaluate: fn(&[f64], &[f64]) -> Response) -> Law {
    Law { law_inputs, acts, evaluate, transition: |_| 0.0, inactive: |parameters| parameters[0] == 0.0 }
}

static BEARING_SPEED: Effect = shape(ActsAt::Bearing, &[law(&[LawInput::Speed], Acts::Torque, against)]);
static BEARING_ANGLE: Effect = shape(ActsAt::Bearing, &[law(&[LawInput::Angle], Acts::Torque, wave_against)]);
static BEARING_TIME: Effect = shape(ActsAt::Bearing, &[law(&[LawInput::Time], Acts::Torque, against)]);
static BEARING_RUBS_BY_ANGLE: Effect = Effect {
    parameters: RUB,
    ..shape(ActsAt::Bearing, &[rub(&[LawInput::Speed, LawInput::Angle], wave_rubs)])
};
static BEARING_RUBS_BY_TIME: Effect = Effect {
    parameters: RUB,
    ..shape(ActsAt::Bearing, &[rub(&[LawInput::Speed, LawInput::Time], hump_rubs)])
};
static SPRING_TWIST: Effect = shape(ActsAt::Spring, &[law(&[LawInput::Twist], Acts::Torque, hump)]);
static SPRING_TIME: Effect =
    shape(ActsAt::Spring, &[law(&[LawInput::Twist, LawInput::Time], Acts::Torque, swelling)]);
static CHANNEL_READING: Effect = shape(ActsAt::Channel, &[law(&[LawInput::Reading], Acts::Reading, hump)]);
static CHANNEL_TIME: Effect = shape(ActsAt::Channel, &[law(&[LawInput::Time], Acts::Reading, hump)]);
static CHANNEL_GAIN: Effect =
    shape(ActsAt::Channel, &[law(&[LawInput::Reading, LawInput::Time], Acts::Reading, swelling)]);

/// A place, what its unknown torque may depend on, and from where to where that goes.
#[derive(Debug, Clone)]
struct Free {
    effect: &'static Effect,
    place: String,
    over: Over,
    unit: &'static str,
    range: (f64, f64),
    /// What one unit of the range is in units of the curve's abscissa: a twist is drawn as the torque that it takes.
    scale: f64,
    /// Likewise of the curve's height: a gain is drawn as what it makes of the largest reading, a stiffness of the largest twist.
    height: f64,
}

/// What remains, as a shape at a place that would carry it.
struct Shape {
    free: Free,
    promise: CandidateScore,
    p_value: f64,
}

/// How a shape acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Manner {
    /// Whatever the sign of what is seen.
    Added,
    /// As a share of what a sensor reads, or of what a spring takes.
    Share,
    /// Against the motion.
    Rubs,
}

/// A shape that was fitted and predicts what it was not fitted to.
#[derive(Debug, Clone)]
pub(crate) struct Unexplained {
    pub(crate) place: String,
    free: Free,
    std: Vec<f64>,
    /// The model with it.
    pub(crate) fitted: FittedModel,
    pub(crate) curve: Curve,
    pub(crate) p_value: f64,
    /// What it gains over the last model without it.
    pub(crate) gain: Difference,
    /// Share of the excess of the training residuals over sensor noise that it carries, per cent.
    pub(crate) misfit_percent: f64,
}

/// A curve that competes with what has a name, if one predicts better: looked for where what has a name leaves more than sensor noise, or
/// where something stands out (`is_suspicious`) and nothing was named.
pub(crate) fn competing(
    context: &Context<'_>,
    path: &Path,
    scales: &Scales,
    named: Option<&Choice>,
    is_suspicious: bool,
) -> Result<Option<Unexplained>, IdentifyError> {
    let excess = named.map_or(path.noise.excess(), |named| named.noise.excess());
    let is_calm = excess < EXCESS;
    if is_calm && named.is_some() {
        return Ok(None);
    }
    let mut free = places(context, &path.last.model, scales);
    free.retain(|free| !is_calm || is_suspicious || free.is_nameless());
    let shapes = all(context, path, &free)?;
    let Some(first) = shapes.first().filter(|first| first.p_value < context.options.false_alarm_rate) else {
        return Ok(None);
    };
    // A curve over a turn is made of several waves, of which a name has one; the others follow.
    let is_wave_of_it = named.is_some_and(|named| {
        let Candidate { place, .. } = &named.term.candidate;
        named.term.candidate.value("order").is_finite() && first.free.is_turn() && *place == first.free.place
    });
    // A curve is linear in its points: it gains little more than its scores promise.
    if is_wave_of_it || named.is_some_and(|named| BEYOND_PROMISE * first.promise.gain < named.fall) {
        return Ok(None);
    }
    let curve =
        fitted(context, path, first)?.filter(|curve| is_possible(&curve.curve, most(path, &first.free)));
    let Some(curve) = curve else { return Ok(None) };
    if curve.gain.log_score <= curve.gain.std {
        return Ok(None);
    }
    match named {
        // It has more parameters: what it does not even fit better, it does not predict better.
        Some(named) if path.last.deviance() - curve.fitted.deviance() < named.fall => Ok(None),
        Some(named) if !curve.beats(context, path, named)? => Ok(None),
        _ => Ok(Some(curve)),
    }
}

/// The largest height that a curve may have: what moves its place, or what its sensor reads.
fn most(path: &Path, free: &Free) -> f64 {
    let rig = &path.known.rig;
    match free.effect.acts_at {
        ActsAt::Bearing => rig.bearing(&free.place).1.torque,
        ActsAt::Spring => rig.spring(&free.place).torque,
        _ => rig.channel(&free.place).largest,
    }
}

/// Whether no point that the recordings determine is beyond that; where the rig shows no size, all are possible.
fn is_possible(curve: &Curve, most: f64) -> bool {
    let known = curve.torque.iter().zip(&curve.torque_std).filter_map(|(height, std)| height.zip(*std));
    most <= 0.0 || known.into_iter().all(|(height, std)| height.abs() - 2.0 * std <= most)
}

/// What each of some places would carry, the one that would carry most first.
fn all(context: &Context<'_>, path: &Path, free: &[Free]) -> Result<Vec<Shape>, IdentifyError> {
    // A turn may be that of a sensor, and then its gaps are those of all that share its pass.
    let (turns, others): (Vec<Free>, Vec<Free>) = free.iter().cloned().partition(Free::is_turn);
    let chunks: Vec<&[Free]> = turns.chunks(TOGETHER).chain(others.chunks(TOGETHER)).collect();
    let each = chunks.into_par_iter().map(|free| together(context, path, free));
    let found: Result<Vec<Vec<(Free, CandidateScore)>>, IdentifyError> = each.collect();
    let found: Vec<(Free, CandidateScore)> = found?.into_iter().flatten().collect();
    let scores_of_candidates: Vec<&CandidateScore> = found.iter().map(|(_, promise)| promise).collect();
    let p_values = score_test::family_wise(&scores_of_candidates);
    let each =
        found.into_iter().zip(p_values).map(|((free, promise), p_value)| Shape { free, promise, p_value });
    let mut found: Vec<Shape> = each.collect();
    found.sort_by(|a, b| b.promise.gain.total_cmp(&a.promise.gain));
    Ok(found)
}

/// All places, with each thing that a torque or an error there may depend on.
fn places(context: &Context<'_>, model: &Model, scales: &Scales) -> Vec<Free> {
    let rotates = model.motion == Motion::Rotation;
    let [by_speed, by_torque] = if rotates { ["rad/s", "N m"] } else { ["m/s", "N"] };
    let mut all = Vec::new();
    let mut add = |effect, place: &str, over, unit, range: (f64, f64), scale, height| {
        if range.1 > range.0 {
            all.push(Free { effect, place: place.to_owned(), over, unit, range, scale, height });
        }
    };
    let (starts, ends) =
        (context.training.iter().map(Dataset::start_s), context.training.iter().map(Dataset::end_s));
    let time_s = (starts.fold(f64::INFINITY, f64::min), ends.fold(f64::NEG_INFINITY, f64::max));
    for bearing in &model.bearings {
        let speed = scales.speed(bearing.node);
        add(&BEARING_SPEED, &bearing.name, Over::Speed, by_speed, (-speed, speed), 1.0, 1.0);
        // What comes back with every turn needs something that turns.
        if rotates {
            let turn = (0.0, std::f64::consts::TAU);
            add(&BEARING_ANGLE, &bearing.name, Over::Angle, "rad", turn, 1.0, 1.0);
            add(&BEARING_RUBS_BY_ANGLE, &bearing.name, Over::Angle, "rad", turn, 1.0, 1.0);
        }
        add(&BEARING_TIME, &bearing.name, Over::Time, "s", time_s, 1.0, 1.0);
        add(&BEARING_RUBS_BY_TIME, &bearing.name, Over::Time, "s", time_s, 1.0, 1.0);
    }
    for (index, spring) in model.springs.iter().enumerate().filter(|(_, spring)| is_part(&spring.name)) {
        // By the file's stiffness: of two springs in a row a fit may make anything.
        let (torque, stiffness) = (scales.torque(index), model.parameters[spring.stiffness].value);
        let twist = torque / stiffness;
        add(&SPRING_TWIST, &spring.name, Over::Torque, by_torque, (-twist, twist), stiffness, 1.0);
        add(&SPRING_TIME, &spring.name, Over::Time, "s", time_s, 1.0, twist);
    }
    for (output, channel) in model.outputs().enumerate() {
        let most = scales.reading(output);
        let over = match channel.quantity {
            socam_model::Quantity::Torque => Over::Torque,
            socam_model::Quantity::Speed => Over::Speed,
            _ => Over::Angle,
        };
        add(&CHANNEL_READING, &channel.name, over, channel.unit, (-most, most), 1.0, 1.0);
        add(&CHANNEL_TIME, &channel.name, Over::Time, "s", time_s, 1.0, 1.0);
        add(&CHANNEL_GAIN, &channel.name, Over::Time, "s", time_s, 1.0, most);
    }
    all
}

impl Free {
    /// Heights' further parameters.
    fn pieces(&self) -> Vec<[f64; 2]> {
        if self.is_turn() {
            let quarter = std::f64::consts::FRAC_PI_2;
            // What rubs may do so all around.
            let mean = (self.acts() == Manner::Rubs).then_some([0.0, quarter]);
            let waves = (1..=ORDERS).flat_map(|order| [[order as f64, 0.0], [order as f64, quarter]]);
            return mean.into_iter().chain(waves).collect();
        }
        let width = (self.range.1 - self.range.0) / (POINTS - 1) as f64;
        (0..POINTS).map(|point| [self.range.0 + width * point as f64, width]).collect()
    }

    /// Whether nothing in the catalogue resembles it, so that no name would point to it: a stiffness that changes.
    fn is_nameless(&self) -> bool {
        self.is_any_of(&[&SPRING_TIME])
    }

    fn is_turn(&self) -> bool {
        self.is_any_of(&[&BEARING_ANGLE, &BEARING_RUBS_BY_ANGLE])
    }

    fn acts(&self) -> Manner {
        if self.is_any_of(&[&CHANNEL_GAIN, &SPRING_TIME]) {
            Manner::Share
        } else if self.is_any_of(&[&BEARING_RUBS_BY_ANGLE, &BEARING_RUBS_BY_TIME]) {
            Manner::Rubs
        } else {
            Manner::Added
        }
    }

    fn is_any_of(&self, effects: &[&'static Effect]) -> bool {
        effects.iter().any(|effect| std::ptr::eq(*effect, self.effect))
    }

    fn curve(&self, model: &Model, heights: &[f64], std: &[f64]) -> Curve {
        let pieces = self.pieces();
        let known = |std: f64| Some(std).filter(|std| std.is_finite());
        let (x, torque, torque_std): (Vec<f64>, Vec<Option<f64>>, Vec<Option<f64>>) = if self.is_turn() {
            let x: Vec<f64> = (0..=36).map(|k| std::f64::consts::TAU * f64::from(k) / 36.0).collect();
            let at = |x: &f64| pieces.iter().zip(heights).map(|(p, h)| h * (p[0] * x + p[1]).sin()).sum();
            let std = std.iter().filter(|std| std.is_finite()).map(|std| std * std).sum::<f64>() / 2.0;
            (x.clone(), x.iter().map(at).map(Some).collect(), vec![known(std.sqrt()); x.len()])
        } else {
            // What never was there has no height.
            let heights =
                heights.iter().zip(std).map(|(height, std)| std.is_finite().then_some(height * self.height));
            let x = pieces.iter().map(|piece| piece[0] * self.scale).collect();
            (x, heights.collect(), std.iter().map(|std| known(std * self.height)).collect())
        };
        let channel = model.channels.iter().find(|channel| channel.name == self.place);
        let own = if model.motion == Motion::Rotation { "N m" } else { "N" };
        Curve {
            over: self.over,
            unit: self.unit.into(),
            x,
            torque,
            torque_std,
            torque_unit: channel.map_or(own, |channel| channel.unit).into(),
        }
    }
}

/// Speed within which friction turns its direction, rad/s (m/s), unless a file says otherwise.
fn transition(motion: Motion) -> f64 {
    let (rotation, translation) = TRANSITION_SPEED;
    if motion == Motion::Rotation { rotation } else { translation }
}

/// The model with a shape's pieces at no height, and the indices of these.
fn grown(model: &Model, free: &Free) -> Result<(Model, Vec<usize>), ModelError> {
    let mut grown = model.clone();
    let mut heights = Vec::new();
    let transition = transition(model.motion);
    for [first, second] in free.pieces() {
        let all = [0.0, first, second, transition];
        grown = grown.with_law(free.effect, &free.place, &all[..free.effect.parameters.len()])?;
        let height = grown.effects.last().map(|used| used.parameters[0]);
        heights.extend(height);
    }
    for height in &heights {
        grown.parameters[*height].fixed = false;
        grown.parameters[*height].bounds = ANY;
    }
    Ok((grown, heights))
}

/// What each of a few shapes would gain, from one evaluation; without those that cannot act.
fn together(
    context: &Context<'_>,
    path: &Path,
    free: &[Free],
) -> Result<Vec<(Free, CandidateScore)>, IdentifyError> {
    let last = &path.last;
    let (mut model, mut heights, mut acting) = (last.model.clone(), Vec::new(), Vec::new());
    for free in free {
        if let Ok((grown, own)) = grown(&model, free) {
            model = grown;
            heights.push(own);
            acting.push(free.clone());
        }
    }
    let values = carried((&last.model, &last.at.values), &model);
    let problem = context.problem(&model)?;
    let base = estimated(&last.model, &model);
    let from = (&last.model, &last.at);
    let scores_of_candidates = comparison::score_test(&problem, &path.noise, &values, from, &base, &heights)?;
    Ok(acting.into_iter().zip(scores_of_candidates.unwrap_or_default()).collect())
}

/// The last model with a shape, at its fit.
fn fitted(context: &Context<'_>, path: &Path, shape: &Shape) -> Result<Option<Unexplained>, IdentifyError> {
    let (last, std) = (&path.last, &shape.promise.std);
    let begun = (&last.model, &*last.at.values);
    let Some((fitted, heights)) = with_shape(context, begun, &path.noise, (&shape.free, std))? else {
        return Ok(None);
    };
    let excess = (last.deviance() * path.noise.excess()).max(1.0);
    Ok(Some(Unexplained {
        place: shape.free.place.clone(),
        curve: shape.free.curve(&last.model, &heights, std),
        p_value: shape.p_value,
        gain: path.gain(&fitted, last),
        misfit_percent: (100.0 * (last.deviance() - fitted.deviance()) * path.noise.excess() / excess)
            .clamp(0.0, 100.0),
        free: shape.free.clone(),
        std: std.clone(),
        fitted,
    }))
}

impl Unexplained {
    pub(crate) fn acts(&self) -> Manner {
        self.free.acts()
    }

    /// Whether it predicts better than what has a name, by more than a standard error and by more than a law's discrepancy makes. Both are
    /// compared under the noise model of the one that leaves less.
    pub(crate) fn beats(
        &self,
        context: &Context<'_>,
        path: &Path,
        named: &Choice,
    ) -> Result<bool, IdentifyError> {
        let FittedModel { model, at, .. } = &self.fitted;
        let own = context.noise_at(model, at, path.noise.levels())?;
        let noise =
            own.filter(|own| own.excess() < named.noise.excess()).unwrap_or_else(|| named.noise.clone());
        let again = |fitted: &FittedModel| context.compared(&fitted.model, &fitted.at, &noise);
        let all = [again(&self.fitted)?, again(&named.fitted)?, again(&named.before)?];
        let [Some(curve), Some(named), Some(before)] = all else { return Ok(false) };
        let (worse, gained) = (path.gain(&curve, &named), path.gain(&curve, &before));
        Ok(worse.log_score > worse.std.max(criterion::by_law(gained.log_score)))
    }

    /// Another model with the same shape, fitted from there.
    pub(crate) fn beside(
        &self,
        context: &Context<'_>,
        (model, values): (&Model, &[f64]),
        noise: &NoiseModel,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        let fitted = with_shape(context, (model, values), noise, (&self.free, &self.std))?;
        Ok(fitted.map(|(fitted, _)| fitted))
    }

    /// The same curve beside a path that has changed, if it is still worth it there.
    pub(crate) fn again(&self, context: &Context<'_>, path: &Path) -> Result<Option<Self>, IdentifyError> {
        let found = together(context, path, std::slice::from_ref(&self.free))?;
        let Some((free, promise)) = found.into_iter().next() else { return Ok(None) };
        let shape = Shape { free, promise, p_value: self.p_value };
        Ok(fitted(context, path, &shape)?.filter(|curve| curve.gain.log_score > curve.gain.std))
    }
}

/// A model with a shape at its fit, and the heights of its points.
fn with_shape(
    context: &Context<'_>,
    (model, values): (&Model, &[f64]),
    noise: &NoiseModel,
    (free, std): (&Free, &[f64]),
) -> Result<Option<(FittedModel, Vec<f64>)>, IdentifyError> {
    let Ok((mut grown, heights)) = grown(model, free) else { return Ok(None) };
    // A point where nothing ever was stays nothing.
    for (height, std) in heights.iter().zip(std) {
        grown.parameters[*height].fixed = !std.is_finite();
    }
    let values = carried((model, values), &grown);
    let problem = context.problem(&grown)?;
    let at = comparison::descend(&problem, noise, &values, None, (comparison::COARSE, ITERATIONS))?;
    let Some(at) = at else { return Ok(None) };
    let found = heights.iter().map(|height| at.values[*height]).collect();
    Ok(context.validated(&grown, at, noise)?.map(|fitted| (fitted, found)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rubs_turns_as_the_catalogue_s_friction_does() {
        let speeds = [Motion::Rotation, Motion::Translation].map(transition);
        assert!(speeds.iter().all(|speed| *speed > 0.0), "{speeds:?}");
    }
}
