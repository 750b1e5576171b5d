//! The next run of a drive: its input signal, which is a profile of speeds or torques, and the limits that the operator sets for it.

use socam_recording::{ProfileCommand, ProfileFile, Waveform};

use crate::device::Effort;
use crate::input_signal::{self, Settings, Signal, SignalShape};
use crate::link::RunLimits;

/// Forms of a profile of speeds or torques: those of the built-in profiles, around standstill.
pub const FORMS: [&str; 7] = ["multisine", "steps", "chirp", "sine", "triangle", "reversals", "prbs"];
/// Largest speed, rad/s, and torque, N m, of a signal while no limit is set.
const LARGEST_RAD_S: f64 = 10.0;
const LARGEST_NM: f64 = 0.1;
/// Rates of change of a signal, in its unit per second.
pub const SLEW: [f64; 2] = [0.01, 4000.0];
/// Acceleration of a signal unless another one is set, rad/s2; of a torque the multiple of its largest, 1/s.
const USUAL_RAD_S2: f64 = 500.0;
const USUAL_1_S: f64 = 100.0;
/// Greatest frequency of a signal, Hz: controllers of speed follow little beyond it.
const HIGHEST_HZ: f64 = 20.0;

/// What the operator has chosen for the next run of a drive.
#[derive(Debug)]
pub struct DriveRun {
    /// The input signal.
    pub signal: Signal,
    /// Limit of the speed, rad/s; 0 until it is set.
    speed_rad_s: f64,
    /// Limit of the torque, N m; 0 until it is set.
    torque_nm: f64,
    /// Limit of the current, A; 0 until it is set.
    current_a: f64,
    /// Address of the device that the limits are for.
    address: String,
}

impl Default for DriveRun {
    fn default() -> Self {
        let settings = form(FORMS[0], ProfileCommand::SpeedClosedLoop, LARGEST_RAD_S)
            .map_or_else(|_| Settings::default(), |file| other(FORMS[0], file));
        Self {
            signal: Signal::of(settings),
            speed_rad_s: 0.0,
            torque_nm: 0.0,
            current_a: 0.0,
            address: String::new(),
        }
    }
}

impl DriveRun {
    /// Another device gets no limits of the one before.
    pub fn connect(&mut self, address: &str) {
        if self.address != address {
            (self.speed_rad_s, self.torque_nm, self.current_a) = (0.0, 0.0, 0.0);
            address.clone_into(&mut self.address);
        }
    }

    /// Limit of the speed, rad/s; 0 until it is set.
    #[must_use]
    pub fn speed_rad_s(&self) -> f64 {
        self.speed_rad_s
    }

    /// Sets the limit of the speed, which the signal does not pass from then on.
    pub fn set_speed(&mut self, speed_rad_s: f64) {
        self.speed_rad_s = speed_rad_s.max(0.0);
        self.fit();
    }

    /// Sets the limit beside the speed; torques do not pass that of the torque.
    pub fn set_effort(&mut self, effort: Effort, value: f64) {
        *(if effort == Effort::Torque { &mut self.torque_nm } else { &mut self.current_a }) = value.max(0.0);
        self.fit();
    }

    /// Fits the signal into what is limited.
    fn fit(&mut self) {
        let SignalShape::Other(name, mut file) = self.signal.settings.kind.clone() else { return };
        let limit = if file.command == ProfileCommand::Torque { self.torque_nm } else { self.speed_rad_s };
        // A profile that was opened stays as it is.
        if limit > 0.0 && FORMS.contains(&name.as_str()) && file.command != ProfileCommand::Voltage {
            fit(&mut file, limit);
            let kind = SignalShape::Other(name, file);
            self.signal.change(Settings { kind, ..self.signal.settings.clone() });
        }
    }

    /// Whether the signal is a torque.
    #[must_use]
    pub fn is_torque(&self) -> bool {
        self.signal.settings.file().command == ProfileCommand::Torque
    }

    /// Makes the signal one of torques, or one of speeds.
    ///
    /// # Errors
    /// Never for the [`FORMS`]; one sentence.
    pub fn set_torque(&mut self, is_torque: bool) -> Result<(), String> {
        let command = if is_torque { ProfileCommand::Torque } else { ProfileCommand::SpeedClosedLoop };
        let name = self.signal.settings.name();
        self.choose_of(FORMS.into_iter().find(|form| *form == name).unwrap_or(FORMS[0]), command)
    }

    /// Limits of a drive, once both are set.
    #[must_use]
    pub fn limits(&self, effort: Effort) -> Option<RunLimits> {
        let value = self.effort(effort);
        (self.speed_rad_s > 0.0 && value > 0.0)
            .then_some(RunLimits { speed_rad_s: self.speed_rad_s, effort: value })
    }

    /// The limit beside the speed; 0 until it is set.
    #[must_use]
    pub fn effort(&self, effort: Effort) -> f64 {
        if effort == Effort::Torque { self.torque_nm } else { self.current_a }
    }

    /// Makes one of the [`FORMS`] the signal, as long as the one before.
    ///
    /// # Errors
    /// When there is none of that name; one sentence.
    pub fn choose(&mut self, name: &str) -> Result<(), String> {
        let is_torque = self.is_torque();
        let command = if is_torque { ProfileCommand::Torque } else { ProfileCommand::SpeedClosedLoop };
        self.choose_of(name, command)
    }

    fn choose_of(&mut self, name: &str, command: ProfileCommand) -> Result<(), String> {
        let (limit, usual) = if command == ProfileCommand::Torque {
            (self.torque_nm, LARGEST_NM)
        } else {
            (self.speed_rad_s, LARGEST_RAD_S)
        };
        let largest = if limit > 0.0 { limit } else { usual };
        let mut file = form(name, command, largest)?;
        let before = self.signal.settings.file();
        file.duration_s = before.duration_s;
        if before.command == command {
            file.slew = before.slew;
            let (amplitude, _) = input_signal::amplitude(&before);
            if amplitude > 0.0 {
                input_signal::set_amplitude(&mut file, amplitude);
            }
        }
        fit(&mut file, largest);
        self.signal.change(other(name, file));
        Ok(())
    }

    /// Why the present signal is none for a drive.
    #[must_use]
    pub fn why_not(&self) -> Option<&'static str> {
        (self.signal.settings.file().command == ProfileCommand::Voltage)
            .then_some("the signal is in volts, and a drive takes speeds or torques: choose another one")
    }
}

fn other(name: &str, file: ProfileFile) -> Settings {
    Settings { kind: SignalShape::Other(name.into(), file), ..Settings::default() }
}

/// A built-in form around zero, half as large as the limit.
fn form(name: &str, command: ProfileCommand, largest: f64) -> Result<ProfileFile, String> {
    let mut file = ProfileFile::open(name).map_err(|error| error.to_string())?;
    file.command = command;
    match &mut file.waveform {
        Waveform::Sine { offset, .. } | Waveform::Triangle { offset, .. } => *offset = 0.0,
        Waveform::Chirp { offset, to_hz, .. } | Waveform::Multisine { offset, to_hz, .. } => {
            (*offset, *to_hz) = (0.0, HIGHEST_HZ);
        }
        Waveform::Prbs { offset, bit_s, .. } => (*offset, *bit_s) = (0.0, 1.0 / HIGHEST_HZ),
        Waveform::Constant { .. } | Waveform::Staircase { .. } => {}
    }
    file.ramp_s = file.ramp_s.max(0.5);
    let slew = if command == ProfileCommand::Torque { USUAL_1_S * largest } else { USUAL_RAD_S2 };
    (file.limit, file.slew) = (largest, slew.clamp(SLEW[0], SLEW[1]));
    input_signal::set_amplitude(&mut file, 0.5 * largest);
    // Those of the built-in profiles speak of a bench of steady speed, and of higher frequencies.
    file.purpose = match name {
        "multisine" => Some(format!(
            "stiffness, damping and inertia: all frequencies from 0.5 to {HIGHEST_HZ} Hz at once, the even ones left free to show nonlinearity"
        )),
        "chirp" => Some(format!(
            "resonances, one after the other: a sine that climbs from 0.5 to {HIGHEST_HZ} Hz with equal time in every octave"
        )),
        "sine" => Some("a sine around zero".into()),
        _ => file.purpose.take(),
    };
    Ok(file)
}

/// Fits a signal into a limit: its amplitude becomes smaller where it passes it.
fn fit(file: &mut ProfileFile, largest: f64) {
    file.limit = largest;
    let (amplitude, most) = input_signal::amplitude(file);
    if amplitude > most && most > 0.0 {
        input_signal::set_amplitude(file, most);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_a_profile_of_speeds_within_the_limit_that_is_set() {
        let mut run = DriveRun::default();
        assert_eq!(run.limits(Effort::Torque), None, "nothing is limited yet, so nothing can be armed");
        run.set_speed(3.0);
        run.set_effort(Effort::Torque, 0.5);
        assert_eq!(run.limits(Effort::Torque), Some(RunLimits { speed_rad_s: 3.0, effort: 0.5 }));
        assert_eq!(run.limits(Effort::Current), None);
        for name in FORMS {
            run.choose(name).unwrap();
            assert_eq!(run.why_not(), None);
            let line = input_signal::preview(&run.signal.settings.file(), 400).unwrap();
            let largest = line.iter().map(|point| point[1].abs()).fold(0.0, f64::max);
            assert!((1.0..=3.0 + 1e-9).contains(&largest), "{name} {largest}");
        }
    }

    #[test]
    fn a_form_keeps_length_and_size_and_another_device_gets_no_limits() {
        let mut run = DriveRun::default();
        run.set_speed(30.0);
        let SignalShape::Other(name, mut file) = run.signal.settings.kind.clone() else { panic!() };
        (file.duration_s, file.slew) = (7.0, 900.0);
        input_signal::set_amplitude(&mut file, 12.0);
        run.signal.change(other(&name, file));
        run.choose("steps").unwrap();
        let file = run.signal.settings.file();
        assert_eq!((file.duration_s, file.slew), (7.0, 900.0));
        assert!((input_signal::amplitude(&file).0 - 12.0).abs() < 1e-9);
        run.connect("moteus:a?id=1");
        assert_eq!(run.speed_rad_s(), 0.0);
        run.set_speed(5.0);
        assert!(input_signal::amplitude(&run.signal.settings.file()).0 <= 5.0);
        run.connect("moteus:a?id=1");
        assert_eq!(run.speed_rad_s(), 5.0);
    }

    #[test]
    fn torques_have_their_own_size_and_stay_within_the_limit_of_torque() {
        let mut run = DriveRun::default();
        run.set_speed(30.0);
        run.set_torque(true).unwrap();
        run.set_effort(Effort::Torque, 0.04);
        for name in FORMS {
            run.choose(name).unwrap();
            let line = input_signal::preview(&run.signal.settings.file(), 400).unwrap();
            let largest = line.iter().map(|point| point[1].abs()).fold(0.0, f64::max);
            assert!(run.is_torque() && (0.01..=0.04 + 1e-9).contains(&largest), "{name} {largest}");
        }
        run.set_torque(false).unwrap();
        assert!(!run.is_torque() && run.signal.settings.file().limit == 30.0);
    }

    #[test]
    fn volts_are_no_signal_for_a_drive() {
        let mut run = DriveRun::default();
        run.signal.take_built_in("steps").unwrap();
        assert!(run.why_not().unwrap().contains("in volts"));
    }
}
