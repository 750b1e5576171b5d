//! Recordings of the default bench by the thesis' own equations (3.7, in deflection coordinates) and a fixed step: nothing is shared
//! with the crates under test.

use std::fmt::Write;

/// The bench's parameters, SI.
#[derive(Debug, Clone, Copy)]
#[expect(missing_docs, reason = "named as in the thesis")]
pub struct Bench {
    pub k1: f64,
    pub k2: f64,
    pub k3: f64,
    pub k4: f64,
    pub c2: f64,
    pub c3: f64,
    pub c4: f64,
    pub c5: f64,
}

/// The catalogue's stiffnesses, away from the default model's start values by a few per cent.
pub const BENCH: Bench =
    Bench { k1: 68.0, k2: 57.0, k3: 52_000.0, k4: 115.0, c2: 0.022, c3: 0.018, c4: 0.085, c5: 0.046 };

/// Sampling interval of the recordings, s.
pub const SAMPLE_TIME_S: f64 = 1e-3;

const J2: f64 = 1.287_502_2e-4;
const J3: f64 = 4.778_417_2e-3;
const J4: f64 = 1.475_2e-2;
const N: f64 = 8.0;
/// The fastest mode is k3/c4, 6e5 1/s: an explicit method needs steps this small.
const STEPS_PER_SAMPLE: u32 = 500;

/// Coupling node, cam shaft, disk side and load, less what a rigid drivetrain would do; then both speeds.
type State = [f64; 6];

impl Bench {
    /// Stiffness of couplings 1 and 2 in series, which the recordings determine.
    #[must_use]
    pub fn k_series_12(&self) -> f64 {
        self.k1 * self.k2 / (self.k1 + self.k2)
    }

    fn slope(&self, [a, b, e, g, v2, v5]: State, motor_speed: f64) -> State {
        let w = motor_speed;
        let da = (-(self.k1 + self.k2) * a + self.k2 * b + self.c3 * (v2 - w)) / (self.c2 + self.c3);
        let pins = self.k3 * (b / N - e);
        let dv2 = (-self.c3 * (v2 - da - w) - self.k2 * (b - a) - pins / N) / (J2 + J3 / (N * N));
        // Coupling 3 carries what the pins carry.
        let de = v5 + (pins - self.k4 * (e - g)) / self.c4 - w / N;
        let dv5 = (pins - self.c5 * v5) / J4;
        [da, v2 - w, de, v5 - w / N, dv2, dv5]
    }

    /// A recording as CSV text: `duration_s` of a motor speed made of lines between 0.5 and 100 Hz around 90 rad/s,
    /// with sensor noise.
    #[must_use]
    pub fn csv(&self, duration_s: f64, seed: u64) -> String {
        let mut noise = Noise(seed);
        let mut csv = String::from("t_s,motor_speed_rad_s,output_speed_rad_s,torque_in_Nm,torque_out_Nm\n");
        let mut state: State = [0.0, 0.0, 0.0, 0.0, motor_speed(0.0), motor_speed(0.0) / N];
        let samples = (duration_s / SAMPLE_TIME_S).round() as u32;
        let step = SAMPLE_TIME_S / f64::from(STEPS_PER_SAMPLE);
        for sample in 0..samples {
            let t = f64::from(sample) * SAMPLE_TIME_S;
            let w = motor_speed(t);
            let [a, b, e, _, _, v5] = state;
            let torque_in = -self.k1 * a - self.c2 * self.slope(state, w)[0];
            let torque_out = self.k3 * (b / N - e);
            writeln!(
                csv,
                "{t:.3},{w:.9},{:.9},{:.9},{:.9}",
                v5 + 0.01 * noise.draw(),
                torque_in + 0.005 * noise.draw(),
                torque_out + 0.02 * noise.draw(),
            )
            .expect("a String takes everything");
            for sub in 0..STEPS_PER_SAMPLE {
                state = self.runge_kutta(state, t + f64::from(sub) * step, step);
            }
        }
        csv
    }

    fn runge_kutta(&self, x: State, t: f64, h: f64) -> State {
        let along = |slope: State, h: f64| std::array::from_fn(|i| x[i] + h * slope[i]);
        let middle = motor_speed(t + h / 2.0);
        let s1 = self.slope(x, motor_speed(t));
        let s2 = self.slope(along(s1, h / 2.0), middle);
        let s3 = self.slope(along(s2, h / 2.0), middle);
        let s4 = self.slope(along(s3, h), motor_speed(t + h));
        std::array::from_fn(|i| x[i] + h / 6.0 * (s1[i] + 2.0 * s2[i] + 2.0 * s3[i] + s4[i]))
    }
}

/// Motor speed, rad/s.
fn motor_speed(t: f64) -> f64 {
    const LINES_HZ: [f64; 8] = [0.5, 3.5, 9.5, 17.0, 29.0, 43.0, 67.0, 95.0];
    let lines =
        LINES_HZ.iter().zip(0..).map(|(f, i)| (std::f64::consts::TAU * f * t + f64::from(i * i)).sin());
    90.0 + 4.0 * lines.sum::<f64>()
}

/// Gaussian enough: the sum of twelve uniform numbers.
pub struct Noise(pub u64);

impl Noise {
    /// The next number, of variance one.
    pub fn draw(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}
