//! The response of modes to an input, computed for as many samples at a time as the processor has SIMD lanes.
//!
//! A scalar recursion waits for its last result at each step. Four steps are one step of a larger recursion, whose four results depend
//! only on the last result and on the inputs' coefficients about the four steps. They are computed side by side.

use nalgebra::Complex;
use pulp::{Simd, WithSimd};

use crate::prediction::phi::Hold;

type C = Complex<f64>;

/// Magnitude below which states are set to zero: arithmetic with subnormal numbers is slow.
const NOTHING: f64 = 1e-200;

/// Response chi of one mode to one input, and its derivative psi with respect to the mode's pole.
#[derive(Clone)]
pub(crate) struct Recursion {
    hold: Hold,
    real: bool,
    /// Steps computed at once.
    steps: usize,
    /// Contributions to chi and psi, one to `steps` samples later, of a unit value of each of the inputs' coefficients about these
    /// steps, then of a unit value of the last chi. A unit value of the last psi contributes to psi what a unit value of chi
    /// contributes to chi. Lanes are steps; the imaginary part of each follows its real part, and a real mode has real parts only.
    weights: Vec<f64>,
    chi: C,
    psi: C,
}

impl Recursion {
    /// Creates a recursion at rest. A real mode has one signal; a complex pair has two, the real and the imaginary part.
    pub(crate) fn new(hold: Hold, real: bool) -> Self {
        let steps = pulp::Arch::new().dispatch(Lanes);
        let mut weights = Vec::new();
        let span = steps + hold.taps.len() - 1;
        for source in 0..=span {
            // A unit value of one coefficient, or for the last source of chi.
            let inputs: Vec<f64> = (0..span).map(|k| if k == source { 1.0 } else { 0.0 }).collect();
            let mut state = (C::from(if source == span { 1.0 } else { 0.0 }), C::default());
            let mut lanes = [const { Vec::new() }; 4];
            for k in 0..steps {
                state = step(&hold, state, &inputs[k..]);
                let parts = [state.0.re, state.0.im, state.1.re, state.1.im];
                for (lane, part) in lanes.iter_mut().zip(parts) {
                    lane.push(if part.abs() < NOTHING { 0.0 } else { part });
                }
            }
            let [chi_re, chi_im, psi_re, psi_im] = lanes;
            let kept = if real { vec![chi_re, psi_re] } else { vec![chi_re, chi_im, psi_re, psi_im] };
            weights.extend(kept.concat());
        }
        Self { hold, real, steps, weights, chi: C::default(), psi: C::default() }
    }

    /// This recursion with the state chi = 1.
    pub(crate) fn left_at_one(&self) -> Self {
        Self { chi: C::from(1.0), psi: C::default(), ..self.clone() }
    }

    /// Magnitude of chi.
    pub(crate) fn size(&self) -> f64 {
        self.chi.norm()
    }

    fn signals(&self) -> usize {
        if self.real { 1 } else { 2 }
    }

    fn write<'s>(&self, k: usize, chi: &mut [&'s mut [f64]], psi: &mut [&'s mut [f64]]) {
        for (signals, state) in [(chi, self.chi), (psi, self.psi)] {
            for (signal, part) in signals.iter_mut().zip([state.re, state.im]) {
                signal[k] = part;
            }
        }
    }
}

/// One step; the coefficients about it come first among `inputs`.
fn step(hold: &Hold, (chi, psi): (C, C), inputs: &[f64]) -> (C, C) {
    let start = (hold.decay * chi, hold.decay * psi + hold.decay_sensitivity * chi);
    hold.taps
        .iter()
        .zip(inputs)
        .fold(start, |sum, ((tap, sensitivity), u)| (sum.0 + tap * u, sum.1 + sensitivity * u))
}

/// Number of lanes of a SIMD vector.
struct Lanes;

impl WithSimd for Lanes {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F64_LANES
    }
}

/// Advances as far as the coefficients `inputs` reach. Writes the modes' chi to the first half of `signals`, and their psi to the second
/// half.
pub(crate) fn advance(recursions: &mut [Recursion], inputs: &[f64], signals: &mut [&mut [f64]]) {
    each(recursions, signals, |recursion, chi, psi| {
        let steps = (inputs.len() + 1).saturating_sub(recursion.hold.taps.len());
        let chunks = steps / recursion.steps;
        pulp::Arch::new().dispatch(Advance { recursion: &mut *recursion, inputs, chi, psi, chunks });
        for k in chunks * recursion.steps..steps {
            let state = step(&recursion.hold, (recursion.chi, recursion.psi), &inputs[k..]);
            (recursion.chi, recursion.psi) = state;
            recursion.write(k, chi, psi);
        }
        if recursion.chi.norm() < NOTHING && recursion.psi.norm() < NOTHING {
            (recursion.chi, recursion.psi) = (C::default(), C::default());
        }
    });
}

/// Writes the present states into the first sample of each signal.
pub(crate) fn now(recursions: &mut [Recursion], signals: &mut [&mut [f64]]) {
    each(recursions, signals, |recursion, chi, psi| recursion.write(0, chi, psi));
}

/// Calls `act` with each mode and its signals.
fn each<'s>(
    recursions: &mut [Recursion],
    signals: &mut [&'s mut [f64]],
    mut act: impl FnMut(&mut Recursion, &mut [&'s mut [f64]], &mut [&'s mut [f64]]),
) {
    let (chi, psi) = signals.split_at_mut(signals.len() / 2);
    let mut signal = 0;
    for recursion in recursions {
        let next = signal + recursion.signals();
        act(recursion, &mut chi[signal..next], &mut psi[signal..next]);
        signal = next;
    }
}

/// Computes the whole SIMD vectors of one mode's samples.
struct Advance<'a, 's> {
    recursion: &'a mut Recursion,
    inputs: &'a [f64],
    chi: &'a mut [&'s mut [f64]],
    psi: &'a mut [&'s mut [f64]],
    chunks: usize,
}

impl WithSimd for Advance<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        debug_assert_eq!(self.recursion.steps, S::F64_LANES);
        if self.chunks == 0 {
        } else if self.recursion.real {
            self.real(simd);
        } else {
            self.pair(simd);
        }
    }
}

impl Advance<'_, '_> {
    #[inline(always)]
    fn real<S: Simd>(self, simd: S) {
        let steps = S::F64_LANES;
        let span = steps + self.recursion.hold.taps.len() - 1;
        let (weights, own) = self.recursion.weights.split_at(2 * steps * span);
        let (weights, own) = (S::as_simd_f64s(weights).0, S::as_simd_f64s(own).0);
        let (decay, sensitivity) = (own[0], own[1]);
        let chi_out = S::as_mut_simd_f64s(&mut self.chi[0][..self.chunks * steps]).0;
        let psi_out = S::as_mut_simd_f64s(&mut self.psi[0][..self.chunks * steps]).0;
        let (mut chi, mut psi) = (self.recursion.chi.re, self.recursion.psi.re);
        let inputs = self.inputs.windows(span).step_by(steps);
        for ((c, p), inputs) in chi_out.iter_mut().zip(psi_out).zip(inputs) {
            let mut sums = [simd.splat_f64s(0.0); 2];
            for (input, weights) in inputs.iter().zip(weights.chunks_exact(2)) {
                let input = simd.splat_f64s(*input);
                sums[0] = simd.mul_add_e_f64s(weights[0], input, sums[0]);
                sums[1] = simd.mul_add_e_f64s(weights[1], input, sums[1]);
            }
            // The last results are added last, so that the sums over the inputs need not wait for them.
            let (last_chi, last_psi) = (simd.splat_f64s(chi), simd.splat_f64s(psi));
            *c = simd.mul_add_e_f64s(decay, last_chi, sums[0]);
            *p = simd.mul_add_e_f64s(decay, last_psi, simd.mul_add_e_f64s(sensitivity, last_chi, sums[1]));
            (chi, psi) = (last::<S>(c), last::<S>(p));
        }
        (self.recursion.chi, self.recursion.psi) = (C::from(chi), C::from(psi));
    }

    #[inline(always)]
    fn pair<S: Simd>(self, simd: S) {
        let steps = S::F64_LANES;
        let span = steps + self.recursion.hold.taps.len() - 1;
        let (weights, own) = self.recursion.weights.split_at(4 * steps * span);
        let (weights, own) = (S::as_simd_f64s(weights).0, S::as_simd_f64s(own).0);
        let (decay, sensitivity) = ([own[0], own[1]], [own[2], own[3]]);
        let ([chi_re, chi_im], [psi_re, psi_im]) = (self.chi, self.psi) else { return };
        let count = self.chunks * steps;
        let chi_re = S::as_mut_simd_f64s(&mut chi_re[..count]).0;
        let chi_im = S::as_mut_simd_f64s(&mut chi_im[..count]).0;
        let psi_re = S::as_mut_simd_f64s(&mut psi_re[..count]).0;
        let psi_im = S::as_mut_simd_f64s(&mut psi_im[..count]).0;
        let chi_out = chi_re.iter_mut().zip(chi_im);
        let psi_out = psi_re.iter_mut().zip(psi_im);
        let (mut chi, mut psi) = (self.recursion.chi, self.recursion.psi);
        let inputs = self.inputs.windows(span).step_by(steps);
        for ((c, p), inputs) in chi_out.zip(psi_out).zip(inputs) {
            let mut sums = [simd.splat_f64s(0.0); 4];
            for (input, weights) in inputs.iter().zip(weights.chunks_exact(4)) {
                let input = simd.splat_f64s(*input);
                for (sum, weight) in sums.iter_mut().zip(weights) {
                    *sum = simd.mul_add_e_f64s(*weight, input, *sum);
                }
            }
            let times = |weight: [S::f64s; 2], number: C, [re, im]: [S::f64s; 2]| {
                let (x, y, minus_y) = (number.re, number.im, -number.im);
                let (x, y, minus_y) = (simd.splat_f64s(x), simd.splat_f64s(y), simd.splat_f64s(minus_y));
                [
                    simd.mul_add_e_f64s(weight[0], x, simd.mul_add_e_f64s(weight[1], minus_y, re)),
                    simd.mul_add_e_f64s(weight[0], y, simd.mul_add_e_f64s(weight[1], x, im)),
                ]
            };
            [*c.0, *c.1] = times(decay, chi, [sums[0], sums[1]]);
            [*p.0, *p.1] = times(decay, psi, times(sensitivity, chi, [sums[2], sums[3]]));
            chi = C::new(last::<S>(c.0), last::<S>(c.1));
            psi = C::new(last::<S>(p.0), last::<S>(p.1));
        }
        (self.recursion.chi, self.recursion.psi) = (chi, psi);
    }
}

/// The last lane of a vector.
#[inline(always)]
fn last<S: Simd>(vector: &S::f64s) -> f64 {
    pulp::bytemuck::cast_slice::<S::f64s, f64>(std::slice::from_ref(vector))[S::F64_LANES - 1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Intersample;

    #[test]
    fn side_by_side_is_one_after_the_other() {
        let inputs: Vec<f64> = (0..28).map(|k| ((k * 7 + 3) % 11) as f64 - 5.0).collect();
        for pole in [C::new(-40.0, 300.0), C::new(-2e5, 0.0), C::default()] {
            let hold = Hold::new(pole, 1e-3, Intersample::BandLimited);
            let real = pole.im == 0.0;
            let mut recursion = Recursion::new(hold.clone(), real);
            let (mut state, mut sizes) = ((C::default(), C::default()), (0.0_f64, 0.0_f64));
            // Blocks of lengths that no number of lanes divides.
            for (from, to) in [(0, 7), (7, 8), (8, 23)] {
                let mut values = vec![vec![f64::NAN; to - from]; 2 * recursion.signals()];
                let mut signals: Vec<&mut [f64]> = values.iter_mut().map(|v| &mut v[..]).collect();
                advance(std::slice::from_mut(&mut recursion), &inputs[from..to + 5], &mut signals);
                for k in from..to {
                    state = step(&hold, state, &inputs[k..]);
                    sizes = (sizes.0.max(state.0.norm()), sizes.1.max(state.1.norm()));
                    let parts = [
                        (state.0.re, sizes.0),
                        (state.0.im, sizes.0),
                        (state.1.re, sizes.1),
                        (state.1.im, sizes.1),
                    ];
                    let expected = parts.iter().step_by(if real { 2 } else { 1 });
                    for (signal, (part, size)) in values.iter().zip(expected) {
                        assert!((signal[k - from] - part).abs() <= 1e-13 * size, "{pole} {k}");
                    }
                }
            }
        }
    }
}
