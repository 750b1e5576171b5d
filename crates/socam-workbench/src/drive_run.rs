//! The next run of a drive: its input signal, which is a profile of speeds, and the limits that the operator sets for it.

use socam_core::Command;
use socam_recording::{ProfileFile, Waveform};

use crate::device::Effort;
use crate::input_signal::{self, Settings, Signal, SignalShape};
use crate::link::RunLimits;

/// Forms of a profile of speeds: those of the built-in profiles, around standstill.
pub const FORMS: [&str; 7] = ["multisine", "steps", "chirp", "sine", "triangle", "reversals", "prbs"];
/// Largest speed of a signal while no limit is set, rad/s.
const LARGEST_RAD_S: f64 = 10.0;
/// Accelerations of a signal, rad/s2.
pub const ACCELERATION_RAD_S2: [f64; 2] = [1.0, 4000.0];
/// Acceleration of a signal unless another one is set, rad/s2.
const USUAL_RAD_S2: f64 = 500.0;
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
    pub torque_nm: f64,
    /// Limit of the current, A; 0 until it is set.
    pub current_a: f64,
    /// Address of the device that the limits are for.
    address: String,
}

impl Default for DriveRun {
    fn default() -> Self {
        let settings =
            form(FORMS[0], LARGEST_RAD_S).map_or_else(|_| Settings::default(), |file| other(FORMS[0], file));
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
        let SignalShape::Other(name, mut file) = self.signal.settings.kind.clone() else { return };
        // A profile that was opened stays as it is.
        if self.speed_rad_s > 0.0 && FORMS.contains(&name.as_str()) && file.command != Command::Voltage {
            fit(&mut file, self.speed_rad_s);
            self.signal
                .change(Settings { kind: SignalShape::Other(name, file), ..self.signal.settings.clone() });
        }
    }

    /// Limits of a drive, once both are set.
    #[must_use]
    pub fn limits(&self, effort: Effort) -> Option<RunLimits> {
        let value = *self.effort(effort);
        (self.speed_rad_s > 0.0 && value > 0.0)
            .then_some(RunLimits { speed_rad_s: self.speed_rad_s, effort: value })
    }

    fn effort(&self, effort: Effort) -> &f64 {
        if effort == Effort::Torque { &self.torque_nm } else { &self.current_a }
    }

    /// The limit beside the speed, which may be set.
    pub fn effort_mut(&mut self, effort: Effort) -> &mut f64 {
        if effort == Effort::Torque { &mut self.torque_nm } else { &mut self.current_a }
    }

    /// Makes one of the [`FORMS`] the signal, as long as the one before.
    ///
    /// # Errors
    /// When there is none of that name; one sentence.
    pub fn choose(&mut self, name: &str) -> Result<(), String> {
        let largest = if self.speed_rad_s > 0.0 { self.speed_rad_s } else { LARGEST_RAD_S };
        let mut file = form(name, largest)?;
        let before = self.signal.settings.file();
        file.duration_s = before.duration_s;
        if before.command != Command::Voltage {
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
        (self.signal.settings.file().command == Command::Voltage)
            .then_some("the signal is in volts, and a drive takes speeds: choose another one")
    }
}

fn other(name: &str, file: ProfileFile) -> Settings {
    Settings { kind: SignalShape::Other(name.into(), file), ..Settings::default() }
}

/// A built-in form of speeds around standstill, half as large as the limit.
fn form(name: &str, largest_rad_s: f64) -> Result<ProfileFile, String> {
    let mut file = ProfileFile::open(name).map_err(|error| error.to_string())?;
    file.command = Command::SpeedClosedLoop;
    match &mut file.waveform {
        Waveform::Sine { offset, .. } | Waveform::Triangle { offset, .. } => *offset = 0.0,
        Waveform::Chirp { offset, to_hz, .. } | Waveform::Multisine { offset, to_hz, .. } => {
            (*offset, *to_hz) = (0.0, HIGHEST_HZ);
        }
        Waveform::Prbs { offset, bit_s, .. } => (*offset, *bit_s) = (0.0, 1.0 / HIGHEST_HZ),
        Waveform::Constant { .. } | Waveform::Staircase { .. } => {}
    }
    file.ramp_s = file.ramp_s.max(0.5);
    (file.limit, file.slew) = (largest_rad_s, USUAL_RAD_S2);
    input_signal::set_amplitude(&mut file, 0.5 * largest_rad_s);
    Ok(file)
}

/// Fits a signal into a limit: its amplitude becomes smaller where it passes it.
fn fit(file: &mut ProfileFile, largest_rad_s: f64) {
    file.limit = largest_rad_s;
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
        *run.effort_mut(Effort::Torque) = 0.5;
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
    fn volts_are_no_signal_for_a_drive() {
        let mut run = DriveRun::default();
        run.signal.take_built_in("steps").unwrap();
        assert!(run.why_not().unwrap().contains("in volts"));
    }
}
