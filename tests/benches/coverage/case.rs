//! What a random bench is: drawn from the seed and its number alone.

use socam_core::scaling::MotorCalibration;
use socam_model::Model;
use socam_recording::{ProfileCommand, ProfileFile, Waveform};
use socam_tests::Draw;

/// The kind of bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub(crate) enum Family {
    /// The default bench, commanded by voltage.
    Chain,
    /// The same with dry friction at the load bearing, which its model names.
    Friction,
    /// The default bench in a closed velocity loop, so that noise of the input comes back as motion.
    ClosedLoop,
    /// Two inertias, driven by a measured torque.
    TwoMass,
    /// A position-controlled axis, identified from its measured force.
    Axis,
}

/// One in twenty each; in this order the kinds are mixed evenly.
const FAMILIES: [Family; 20] = {
    use Family::{Axis, Chain, ClosedLoop, Friction, TwoMass};
    [
        Chain, Chain, Friction, Chain, Chain, ClosedLoop, Chain, Chain, TwoMass, Chain, Chain, Axis, Chain,
        Chain, Friction, Chain, ClosedLoop, Chain, TwoMass, Chain,
    ]
};

impl Family {
    pub(crate) const ALL: [Self; 5] =
        [Self::Chain, Self::Friction, Self::ClosedLoop, Self::TwoMass, Self::Axis];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Chain => "chain",
            Self::Friction => "friction",
            Self::ClosedLoop => "closed loop",
            Self::TwoMass => "two-mass",
            Self::Axis => "axis",
        }
    }

    /// The model that is simulated.
    pub(crate) fn plant(self) -> Result<Model, String> {
        if self == Self::Axis { built_in("emps-loop") } else { self.model() }
    }

    /// The model that is identified.
    pub(crate) fn model(self) -> Result<Model, String> {
        match self {
            Self::Chain | Self::ClosedLoop => built_in("speed-o-cam"),
            Self::Friction => with_friction(),
            Self::TwoMass => built_in("two-mass"),
            Self::Axis => built_in("emps"),
        }
    }

    /// The input's channel and the four standard deviations that its noise may have, SI.
    fn input_noise(self) -> (&'static str, [f64; LEVELS]) {
        match self {
            Self::Chain | Self::Friction | Self::ClosedLoop => ("motor_speed", MOTOR_SPEED_NOISE),
            Self::TwoMass => ("motor_torque", [0.0, 1e-3, 4e-3, 2e-2]),
            Self::Axis => ("force", [0.0, 0.05, 0.2, 1.0]),
        }
    }

    /// Output channels and their usual noise, SI.
    fn output_noise(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Chain | Self::Friction | Self::ClosedLoop => {
                &[("output_speed", 0.01), ("torque_in", 2e-3), ("torque_out", 1e-2)]
            }
            Self::TwoMass => &[("motor_speed", 0.02), ("load_speed", 0.02)],
            Self::Axis => &[("position", 5e-5)],
        }
    }

    fn profiles(self) -> &'static [&'static str] {
        match self {
            Self::Chain | Self::ClosedLoop | Self::TwoMass => &["multisine", "steps", "chirp", "prbs"],
            Self::Friction => &["multisine", "steps", "chirp", "prbs", "triangle", "reversals", "sine"],
            Self::Axis => &["multisine", "steps", "triangle", "sine"],
        }
    }
}

/// Number of noise levels of an input.
pub(crate) const LEVELS: usize = 4;

/// Noise of the motor's tachometer, rad/s.
pub(crate) const MOTOR_SPEED_NOISE: [f64; LEVELS] = [0.0, 0.005, 0.02, 0.1];

/// Stiffnesses, dampings and masses lie within this factor of the model file's, either way.
const SPREAD: f64 = 2.0;

/// Noise of the outputs lies within this factor of the usual one.
const NOISE_SPREAD: f64 = 3.0;

fn built_in(name: &str) -> Result<Model, String> {
    Model::builtin(name).ok_or_else(|| format!("there is no model {name}"))
}

fn with_friction() -> Result<Model, String> {
    let (_, text) = socam_model::BUILTIN[0];
    let parameter = "\nTc = { value = 0.3, unit = \"N m\", bounds = [0, 100], source = \"assumed\" }\nJ2 = {";
    let effect = "\n[[effects]]\neffect = \"coulomb_friction\"\nat = \"load_bearing\"\nparameters = { torque = \"Tc\" }\n";
    Model::parse(&(text.replacen("\nJ2 = {", parameter, 1) + effect)).map_err(|error| error.to_string())
}

/// A random bench with everything that is known of it.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) number: u64,
    pub(crate) family: Family,
    /// Which of the input's noise levels.
    pub(crate) level: usize,
    /// True values of the parameters to be identified, SI.
    pub(crate) truth: Vec<(String, f64)>,
    /// Whether the fit starts from random values; otherwise from the model file's.
    pub(crate) starts_anywhere: bool,
    /// Starts that compete; as many as by default if `None`.
    pub(crate) starts: Option<usize>,
    /// Where the fit starts, SI.
    pub(crate) start: Vec<(String, f64)>,
    /// Noise of all channels, SI.
    pub(crate) noise: Vec<(String, f64)>,
    /// Of the velocity loop: V per rad/s, and V per rad.
    pub(crate) gains: (f64, f64),
    pub(crate) runs: Vec<Run>,
}

/// A recording to be made.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) name: &'static str,
    pub(crate) profile: ProfileFile,
    /// Draws the sensors' noise.
    pub(crate) seed: u64,
}

impl Case {
    /// Case `number` of those that belong to a seed.
    pub(crate) fn draw(seed: u64, number: u64) -> Result<Self, String> {
        let mut draw = Draw::new(seed, number);
        // Both halves of the cases get all noise levels and kinds of benches in turn.
        let place = number / 2;
        let level = (place % LEVELS as u64) as usize;
        let family = FAMILIES[((place / LEVELS as u64 + 5 * (place % LEVELS as u64)) % 20) as usize];
        let model = family.model()?;
        let free = || model.parameters.iter().filter(|parameter| !parameter.fixed);
        let truth = free().map(|p| (p.name.clone(), p.value * draw.factor(SPREAD))).collect();
        let starts_anywhere = draw.chance(0.5);
        let spread = if starts_anywhere { SPREAD } else { 1.0 };
        let start = free().map(|p| (p.name.clone(), p.value * draw.factor(spread))).collect();
        let (input, stds) = family.input_noise();
        let outputs = family.output_noise().iter();
        let outputs = outputs.map(|(name, std)| ((*name).to_owned(), std * draw.factor(NOISE_SPREAD)));
        let noise = std::iter::once((input.to_owned(), stds[level])).chain(outputs).collect();
        let gains = (0.005 * draw.between(1.0, 3.0), 0.1 * draw.between(1.0, 5.0));
        let runs = (0..draw.whole(1, 4)).map(|_| run(family, &mut draw)).collect::<Result<_, _>>()?;
        Ok(Self { number, family, level, truth, starts_anywhere, starts: None, start, noise, gains, runs })
    }

    pub(crate) fn is_kept_aside(&self) -> bool {
        self.number % 2 == 1
    }

    /// Which of [`MOTOR_SPEED_NOISE`]; `None` where the input is no motor speed.
    pub(crate) fn motor_speed_level(&self) -> Option<usize> {
        matches!(self.family, Family::Chain | Family::Friction | Family::ClosedLoop).then_some(self.level)
    }

    /// Whether a command that jumps excites the bench, beyond what sampling resolves.
    pub(crate) fn has_prbs(&self) -> bool {
        self.runs.iter().any(|run| matches!(run.profile.waveform, Waveform::Prbs { .. }))
    }

    /// The same with its fit begun at the truth.
    pub(crate) fn begun_at_truth(self) -> Self {
        Self { start: self.truth.clone(), starts: Some(1), ..self }
    }

    /// Length of all recordings, without their fading out.
    pub(crate) fn duration_s(&self) -> f64 {
        self.runs.iter().map(|run| run.profile.duration_s).sum()
    }
}

fn run(family: Family, draw: &mut Draw) -> Result<Run, String> {
    let name = draw.one_of(family.profiles());
    let mut profile = ProfileFile::open(name).map_err(|error| error.to_string())?;
    profile.duration_s = (draw.between(5.0, 20.0) * 1e3).round() * 1e-3;
    let strength = draw.between(0.5, 1.2);
    let phases = draw.whole(1, 60_000);
    match &mut profile.waveform {
        Waveform::Multisine { amplitude, seed, .. } => {
            *amplitude *= strength;
            *seed = phases as u32;
        }
        Waveform::Prbs { amplitude, seed, .. } => {
            *amplitude *= strength;
            *seed = phases as u16;
        }
        Waveform::Chirp { amplitude, sweep_s, .. } => {
            *amplitude *= strength;
            *sweep_s = sweep_s.min(profile.duration_s - profile.ramp_s);
        }
        Waveform::Sine { amplitude, periods, .. } => {
            *amplitude *= strength;
            *periods = None;
        }
        Waveform::Triangle { amplitude, .. } => *amplitude *= strength.min(1.1),
        Waveform::Staircase { dwell_s, .. } => *dwell_s = (draw.between(0.5, 1.5) * 1e3).round() * 1e-3,
        Waveform::Constant { .. } => {}
    }
    match family {
        Family::ClosedLoop => command_speed(&mut profile),
        Family::Axis => spare_the_servo(&mut profile),
        Family::Chain | Family::Friction | Family::TwoMass => {}
    }
    Ok(Run { name, profile, seed: draw.seed() })
}

/// The same waveform as a motor speed, by the motor's calibration.
fn command_speed(profile: &mut ProfileFile) {
    let motor = MotorCalibration::LOADED;
    let speed = |volts: f64| motor.speed_rad_s(volts);
    let per_volt = speed(1.0) - speed(0.0);
    profile.command = ProfileCommand::SpeedClosedLoop;
    profile.limit = speed(profile.limit);
    // What a profile may ask for at most.
    profile.slew = (profile.slew * per_volt).min(4000.0);
    match &mut profile.waveform {
        Waveform::Multisine { offset, amplitude, .. }
        | Waveform::Chirp { offset, amplitude, .. }
        | Waveform::Prbs { offset, amplitude, .. }
        | Waveform::Sine { offset, amplitude, .. }
        | Waveform::Triangle { offset, amplitude, .. } => {
            *offset = speed(*offset);
            *amplitude *= per_volt;
        }
        Waveform::Staircase { first, step, .. } => {
            *first = speed(*first);
            *step *= per_volt;
        }
        Waveform::Constant { level } => *level = speed(*level),
    }
}

/// A stiff position loop answers a reference that jumps with forces beyond its sensor's range.
fn spare_the_servo(profile: &mut ProfileFile) {
    profile.ramp_s = 1.0;
    profile.slew = profile.slew.min(2.0);
    match &mut profile.waveform {
        Waveform::Multisine { offset, to_hz, .. } => (*offset, *to_hz) = (0.0, 10.0),
        Waveform::Sine { offset, .. } => *offset = 0.0,
        _ => {}
    }
}

/// Makes what moves the bench weaker, all else equal.
pub(crate) fn soften(profile: &mut ProfileFile, factor: f64) {
    match &mut profile.waveform {
        Waveform::Multisine { amplitude, .. }
        | Waveform::Chirp { amplitude, .. }
        | Waveform::Prbs { amplitude, .. }
        | Waveform::Sine { amplitude, .. }
        | Waveform::Triangle { amplitude, .. } => *amplitude *= factor,
        Waveform::Staircase { first, step, .. } => {
            *first *= factor;
            *step *= factor;
        }
        Waveform::Constant { level } => *level *= factor,
    }
}
