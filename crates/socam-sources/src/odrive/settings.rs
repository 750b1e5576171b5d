//! Settings that an ODrive is given before it is commanded, and the names of what it knows.

use std::f64::consts::TAU;

use crate::drive::{Commands, Limits, Readiness};

/// Generation of the firmware, which names things by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Generation {
    /// 0.5.
    Early,
    /// 0.6.
    Late,
}

/// Bits of the error of an axis by the firmware 0.5, and of `active_errors` by 0.6: those that end a run.
const EARLY_ERRORS: [(u64, &str); 9] = [
    (0x1, "invalid state"),
    (0x40, "motor failed"),
    (0x80, "sensorless estimator failed"),
    (0x100, "encoder failed"),
    (0x200, "controller failed"),
    (0x800, "watchdog timer expired"),
    (0x1000, "end stop pressed"),
    (0x4000, "emergency stop requested"),
    (0x40000, "over-temperature"),
];
const LATE_ERRORS: [(u64, &str); 15] = [
    (0x4, "timing error"),
    (0x8, "missing estimate"),
    (0x10, "bad configuration"),
    (0x20, "gate driver fault"),
    (0x40, "missing input"),
    (0x100, "over-voltage of the supply"),
    (0x200, "under-voltage of the supply"),
    (0x400, "over-current of the supply"),
    (0x800, "over-current into the supply"),
    (0x1000, "limit of current violated"),
    (0x2000, "motor over-temperature"),
    (0x4000, "inverter over-temperature"),
    (0x8000, "limit of speed violated"),
    (0x100_0000, "watchdog timer expired"),
    (0x200_0000, "emergency stop requested"),
];

impl Generation {
    pub(super) fn other(self) -> Self {
        if self == Self::Early { Self::Late } else { Self::Early }
    }

    /// The bit of an error that its watchdog sets.
    #[cfg(feature = "can")]
    pub(crate) fn watchdog(self) -> u64 {
        if self == Self::Early { 0x800 } else { 0x100_0000 }
    }

    /// Name of the measured current.
    pub(super) fn current(self) -> &'static str {
        if self == Self::Early { "motor.current_control.Iq_measured" } else { "motor.foc.Iq_measured" }
    }

    /// Name of the error.
    pub(super) fn error(self) -> &'static str {
        if self == Self::Early { "error" } else { "active_errors" }
    }

    /// The sentence that says what an error means.
    pub(crate) fn fault_text(self, code: u64) -> String {
        let known = if self == Self::Early { &EARLY_ERRORS[..] } else { &LATE_ERRORS[..] };
        let names: Vec<&str> =
            known.iter().filter(|(bit, _)| code & bit != 0).map(|(_, name)| *name).collect();
        let names = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
        format!("the ODrive reports error {code:#x}{names}")
    }

    /// Names of the settings of [`Settings::wanted`], in its order.
    fn settings(self) -> [&'static str; SETTINGS] {
        let current =
            if self == Self::Early { "motor.config.current_lim" } else { "config.motor.current_soft_max" };
        [
            "controller.config.vel_limit",
            current,
            "config.watchdog_timeout",
            "config.enable_watchdog",
            "controller.config.control_mode",
            "controller.config.input_mode",
            // Whether the speed limit holds for torques too.
            "controller.config.enable_torque_mode_vel_limit",
        ]
    }
}

/// Number of settings, and their places: speed limit, current limit, time of the watchdog, whether it is on, two modes, and whether torques
/// have the speed limit, which is asked for where torques are commanded.
const SETTINGS: usize = 7;
const SPEED: usize = 0;
const CURRENT: usize = 1;
const WATCHDOG: usize = 2;
const IS_WATCHED: usize = 3;
const MODES: usize = 4;
const TORQUES_TOO: usize = 6;
/// Control of speed and of torque; the command is taken as it is.
const CONTROL_SPEED: f64 = 2.0;
const CONTROL_TORQUE: f64 = 1.0;
const INPUT_AS_IT_IS: f64 = 1.0;

/// Settings of a run.
#[derive(Debug, Clone)]
pub(super) struct Settings {
    limits: Limits,
    /// What the drive had before, once it has said so.
    before: Option<Vec<f64>>,
    readiness: Readiness,
}

impl Settings {
    pub(super) fn new(limits: Limits) -> Self {
        Self { limits, before: None, readiness: Readiness::Pending }
    }

    /// The names of the settings of this run.
    fn names(&self, generation: Generation) -> Vec<&'static str> {
        let all = generation.settings();
        let count = if self.limits.commands == Commands::Torques { SETTINGS } else { TORQUES_TOO };
        all[..count].to_vec()
    }

    pub(super) fn readiness(&self) -> Readiness {
        self.readiness.clone()
    }

    /// What is to be asked for: the state, and all settings until the drive has the wanted ones.
    pub(super) fn asked(&self, axis: u8, generation: Generation) -> Vec<String> {
        let mut names = vec![format!("axis{axis}.current_state")];
        if self.readiness == Readiness::Pending {
            names.extend(self.names(generation).iter().map(|name| format!("axis{axis}.{name}")));
        }
        names
    }

    /// Takes the answers for the settings.
    pub(super) fn heard(&mut self, answers: &[Option<f64>]) {
        if self.readiness != Readiness::Pending {
            return;
        }
        let now: Vec<f64> = answers.iter().copied().flatten().collect();
        let count = self.names(Generation::Early).len();
        if now.len() != count || answers.len() != count {
            let what = if count == SETTINGS {
                "the ODrive does not state its limits, its watchdog, and whether it limits the speed under a torque, so it is not commanded"
            } else {
                "the ODrive does not state its limits and its watchdog, so it is not commanded"
            };
            self.readiness = Readiness::Refused(what.into());
            return;
        }
        let Some(before) = &self.before else {
            self.before = Some(now.clone());
            let own_rad_s = now[SPEED] * TAU;
            if own_rad_s < self.limits.speed_rad_s * (1.0 - 1e-4)
                || now[CURRENT] < self.limits.effort * (1.0 - 1e-4)
            {
                self.readiness = Readiness::Refused(format!(
                    "the ODrive's own limits are {own_rad_s:.4} rad/s and {:.4} A, below the limits of the run: lower these, or raise its own",
                    now[CURRENT]
                ));
            }
            return;
        };
        let wanted = self.wanted(before);
        let is_same = |(now, wanted): (&f64, &f64)| (now - wanted).abs() <= 1e-3 * wanted.abs();
        if now.iter().zip(&wanted).all(is_same) {
            self.readiness = Readiness::Ready;
        }
    }

    fn wanted(&self, before: &[f64]) -> Vec<f64> {
        let mut wanted = before.to_vec();
        wanted[SPEED] = self.limits.speed_rad_s / TAU;
        wanted[CURRENT] = self.limits.effort;
        wanted[WATCHDOG] = self.limits.watchdog_s;
        wanted[IS_WATCHED] = 1.0;
        let is_torque = self.limits.commands == Commands::Torques;
        wanted[MODES] = if is_torque { CONTROL_TORQUE } else { CONTROL_SPEED };
        wanted[MODES + 1] = INPUT_AS_IT_IS;
        wanted.iter_mut().skip(TORQUES_TOO).for_each(|too| *too = 1.0);
        wanted
    }

    /// The lines that give it the settings; its watchdog is fed before it is switched on.
    pub(super) fn writes(&self, axis: u8, generation: Generation) -> String {
        let Some(before) = &self.before else { return String::new() };
        // Each of these sets the mode of control too, as does the setting below.
        let mut lines = match self.limits.commands {
            Commands::Speeds => format!("v {axis} 0 0\n"),
            Commands::Torques => format!("c {axis} 0\n"),
        };
        for (index, (name, value)) in self.names(generation).iter().zip(self.wanted(before)).enumerate() {
            if index == IS_WATCHED {
                lines.push_str(&format!("u {axis}\n"));
            }
            lines.push_str(&format!("w axis{axis}.{name} {}\n", short(value)));
        }
        lines
    }

    /// The lines that give it back what it had, its watchdog first, which nobody feeds any more.
    pub(super) fn undo(&self, axis: u8, generation: Generation) -> String {
        let Some(before) = &self.before else { return String::new() };
        let all = self.names(generation);
        let order = [IS_WATCHED, WATCHDOG, CURRENT, SPEED, MODES, MODES + 1, TORQUES_TOO];
        let lines = order.iter().filter(|index| **index < all.len());
        lines.map(|index| format!("w axis{axis}.{} {}\n", all[*index], short(before[*index]))).collect()
    }

    pub(super) fn promises(&self) -> [Vec<String>; 2] {
        let Limits { speed_rad_s, effort, watchdog_s, commands, .. } = self.limits;
        let of_torques = (commands == Commands::Torques).then(|| {
            "Under a torque the axis limits its speed by taking torque away near its speed limit, and is commanded only if it states that it does.".to_owned()
        });
        let torques_not = (commands == Commands::Torques).then(|| {
            "A torque is a current by the drive's own torque constant: where that is wrong, so is the torque. A load can turn it faster than its limit: this computer stops it then.".to_owned()
        });
        [
            vec![
                format!("The axis gets a speed limit of {speed_rad_s} rad/s and a current limit of {effort} A, and is commanded only if it states them."),
                format!(
                    "The axis gets a watchdog, and is commanded only if it states it: it switches its motor off {watchdog_s} s after the last command that it got."
                ),
                "After the run these settings become what they were; none is saved in the drive.".into(),
            ]
            .into_iter()
            .chain(of_torques)
            .collect(),
            vec![
                "A motor that is switched off coasts, by the watchdog as at the end: nothing brakes it, and a weight falls.".into(),
                "If this program is killed, the limits and the watchdog stay until the drive is restarted.".into(),
            ]
            .into_iter()
            .chain(torques_not)
            .collect(),
        ]
    }
}

/// A number with the digits that a drive's own numbers have.
fn short(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
