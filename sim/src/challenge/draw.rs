//! Draws the parts of a case: machine, hidden effects and places, recordings, noise.

use super::families::FAMILIES;
use super::hidden;
use super::kind::CaseKind;
use super::machine::{Drive, Machine};
use super::profile::{self, Profile, Shape};
use super::random::Draw;
use super::scales::Scales;
use super::simulate::Run;

/// An effect's id and its place.
pub(super) type Chosen = (&'static str, String);

/// The machine of a case and its hidden effects with their places, without simulating anything.
pub(super) fn outline(number: u64, draw: &mut Draw) -> (Machine, Vec<Chosen>) {
    let (kind, turn) = CaseKind::turn(number);
    let named = |index: u64| hidden::NAMED[(index % hidden::NAMED.len() as u64) as usize];
    let outside = |index: u64| hidden::OUTSIDE[(index % hidden::OUTSIDE.len() as u64) as usize];
    loop {
        let (_, family) = draw.one_of(&FAMILIES);
        let machine = family(draw);
        let effects = match kind {
            CaseKind::Clean => vec![],
            CaseKind::Single => vec![named(turn)],
            CaseKind::Outside => vec![outside(turn)],
            CaseKind::Double => vec![named(turn), named(draw.whole(0, hidden::NAMED.len() as u64 - 1))],
        };
        if let Some(chosen) = choose(&machine, &effects, draw) {
            return (machine, chosen);
        }
    }
}

/// A place for each effect; `None` where the machine has none, or two effects are hard to distinguish.
fn choose(machine: &Machine, effects: &[&'static str], draw: &mut Draw) -> Option<Vec<Chosen>> {
    let mut chosen: Vec<Chosen> = Vec::new();
    for effect in effects {
        let places = hidden::places(machine, effect);
        if places.is_empty() || chosen.iter().any(|(other, _)| are_similar(other, effect)) {
            return None;
        }
        let place = places[draw.whole(0, places.len() as u64 - 1) as usize].clone();
        if chosen.iter().any(|(_, other)| *other == place) {
            return None;
        }
        chosen.push((effect, place));
    }
    Some(chosen)
}

/// Whether one effect is often mistaken for the other.
fn are_similar(a: &str, b: &str) -> bool {
    let pair = |first: &str, second: &str| (a, b) == (first, second) || (b, a) == (first, second);
    a == b
        || pair("constant_load", "direction_dependence")
        || pair("coulomb_friction", "stribeck_friction")
        || pair("sensor_lag", "sensor_delay")
}

/// Four to six recordings, of which one or two are held out, and the number that is fitted.
pub(super) fn runs(machine: &Machine, draw: &mut Draw) -> (Vec<Run>, usize) {
    let (training, held_out) = (draw.whole(3, 4) as usize, draw.whole(1, 2) as usize);
    let must = [draw.one_of(&profile::SHAKING), draw.one_of(&profile::REVERSING)];
    let all: Vec<Shape> = profile::SHAKING.into_iter().chain(profile::REVERSING).collect();
    let rest: Vec<Shape> = all.iter().copied().filter(|shape| !must.contains(shape)).collect();
    let mut shapes = must.to_vec();
    shapes.extend(draw.shuffled(&rest).into_iter().take(training - 2));
    shapes = draw.shuffled(&shapes);
    // Held-out profiles are others, or the same with other phases and amplitudes.
    shapes.extend(draw.shuffled(&all).into_iter().take(held_out));
    let run = |shape: Shape| {
        let duration_s = draw.between(5.0, 10.0);
        let strength = (machine.amplitude * draw.between(0.7, 1.1), machine.mean * draw.between(-1.0, 1.0));
        // A bench driven in one direction never stops.
        let mean =
            if machine.mean > 1.0 { machine.mean * draw.sign() * draw.between(0.6, 1.0) } else { strength.1 };
        let mean = if profile::REVERSING.contains(&shape) { 0.1 * mean } else { mean };
        let profile = Profile::draw(shape, (strength.0, mean), duration_s, machine.band_hz, draw);
        Run { profile, duration_s, noise_seed: draw.seed() }
    };
    (shapes.into_iter().map(run).collect(), training)
}

/// Standard deviation of the noise of every channel.
pub(super) fn noise(
    machine: &Machine,
    scales: &Scales,
    realistic: bool,
    draw: &mut Draw,
) -> Vec<(String, f64)> {
    let channels = machine.channels();
    let each = channels.iter().enumerate().map(|(index, channel)| {
        let size = scales.channels[index];
        let std = match index.checked_sub(1) {
            None if machine.input.drive == Drive::Speed && draw.chance(0.8) => size * draw.log((1e-4, 3e-3)),
            // The command of a drive is noise-free, unless a realistic case measures its torque.
            None if machine.input.drive == Drive::Torque && realistic => size * draw.log((3e-4, 3e-3)),
            None => 0.0,
            Some(sensor) if machine.sensors[sensor].step > 0.0 => 0.3 * machine.sensors[sensor].step,
            Some(_) => size * draw.log((2e-3, 1e-2)),
        };
        (channel.name.clone(), std)
    });
    each.collect()
}
