//! The input signal: a sine or a constant within the limits of the thesis' program, or any other profile.

use socam_recording::{ProfileCommand, ProfileFile, Waveform};

/// Amplitudes of the sine, V.
pub const AMPLITUDE_V: [f64; 2] = [0.2, 2.3];
/// Frequencies of the sine, Hz.
pub const FREQUENCY_HZ: [f64; 2] = [0.05, 5.0];
/// Limit of the command, V: offset plus amplitude.
pub const LIMIT_V: f64 = 2.5;
/// Durations, s.
pub const DURATION_S: [f64; 2] = [1.0, 600.0];

/// Kind of a signal.
#[derive(Debug, Clone, PartialEq)]
pub enum SignalShape {
    /// A sine around an offset.
    Sine,
    /// A constant voltage.
    Constant,
    /// Another profile: a built-in one by name, or one that was opened.
    Other(String, ProfileFile),
}

/// Settings of the panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Kind of signal.
    pub kind: SignalShape,
    /// Amplitude of the sine, V.
    pub amplitude_v: f64,
    /// Frequency of the sine, Hz.
    pub frequency_hz: f64,
    /// Offset of the sine, V.
    pub offset_v: f64,
    /// Level of the constant, V.
    pub level_v: f64,
    /// Duration of the sine and the constant, s.
    pub duration_s: f64,
    /// Duration that somebody chose, s: that of whichever built-in signal is chosen next, too.
    pub chosen_duration_s: Option<f64>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            kind: SignalShape::Sine,
            amplitude_v: 0.4,
            frequency_hz: 1.0,
            offset_v: 1.2,
            level_v: 1.0,
            duration_s: 10.0,
            chosen_duration_s: None,
        }
    }
}

impl Settings {
    /// Duration of the signal, s.
    fn length_s(&self) -> f64 {
        match &self.kind {
            SignalShape::Other(_, file) => file.duration_s,
            SignalShape::Sine | SignalShape::Constant => self.duration_s,
        }
    }

    /// Notes a duration that was changed, and gives a signal that was chosen instead of `before` the one that was chosen for that.
    fn keep_duration(&mut self, before: &Self) {
        let is_same = match (&self.kind, &before.kind) {
            (SignalShape::Other(name, _), SignalShape::Other(other, _)) => name == other,
            (own, other) => own == other,
        };
        if is_same && self.length_s() != before.length_s() {
            self.chosen_duration_s = Some(self.length_s());
        }
        let Some(chosen_s) = self.chosen_duration_s.filter(|_| !is_same) else { return };
        match &mut self.kind {
            SignalShape::Other(_, file) => file.duration_s = chosen_s,
            SignalShape::Sine | SignalShape::Constant => self.duration_s = chosen_s,
        }
    }

    /// Limits all settings. Returns a note on what was limited, if anything.
    pub fn limit(&mut self) -> Option<String> {
        let before = self.clone();
        let clamp =
            |value: f64, [low, high]: [f64; 2]| if value.is_finite() { value.clamp(low, high) } else { low };
        self.amplitude_v = clamp(self.amplitude_v, AMPLITUDE_V);
        self.frequency_hz = clamp(self.frequency_hz, FREQUENCY_HZ);
        self.level_v = clamp(self.level_v, [-LIMIT_V, LIMIT_V]);
        let room = LIMIT_V - self.amplitude_v;
        self.offset_v = clamp(self.offset_v, [-room, room]);
        self.duration_s = clamp(self.duration_s, DURATION_S);
        let said = [
            ("amplitude", before.amplitude_v, self.amplitude_v, "V"),
            ("frequency", before.frequency_hz, self.frequency_hz, "Hz"),
            ("offset", before.offset_v, self.offset_v, "V"),
            ("level", before.level_v, self.level_v, "V"),
            ("duration", before.duration_s, self.duration_s, "s"),
        ];
        let changed = said.iter().find(|(_, asked, given, _)| asked != given);
        changed.map(|(name, asked, given, unit)| {
            format!("{name} {asked} {unit} is outside the limits; it is {given:.3} {unit} now")
        })
    }

    /// The profile for a board.
    #[must_use]
    pub fn file(&self) -> ProfileFile {
        let waveform = match &self.kind {
            SignalShape::Sine => Waveform::Sine {
                offset: self.offset_v,
                amplitude: self.amplitude_v,
                frequency_hz: self.frequency_hz,
                periods: None,
            },
            SignalShape::Constant => Waveform::Constant { level: self.level_v },
            SignalShape::Other(_, file) => return file.clone(),
        };
        ProfileFile {
            purpose: None,
            command: ProfileCommand::Voltage,
            waveform,
            ramp_s: 0.25,
            limit: LIMIT_V,
            slew: 20.0,
            duration_s: self.duration_s,
        }
    }

    /// Name for the recording.
    #[must_use]
    pub fn name(&self) -> String {
        match &self.kind {
            SignalShape::Sine => "sine".into(),
            SignalShape::Constant => "constant".into(),
            SignalShape::Other(name, _) => name.clone(),
        }
    }
}

/// By how much steps that a board rounds to millionths may pass their largest level.
const ROUNDED: f64 = 1e-5;

/// The amplitude of a profile, of steps their largest level, and the greatest one that its limit leaves beside its offset.
#[must_use]
pub fn amplitude(file: &ProfileFile) -> (f64, f64) {
    match file.waveform {
        Waveform::Sine { offset, amplitude, .. }
        | Waveform::Triangle { offset, amplitude, .. }
        | Waveform::Chirp { offset, amplitude, .. }
        | Waveform::Prbs { offset, amplitude, .. }
        | Waveform::Multisine { offset, amplitude, .. } => (amplitude, file.limit - offset.abs()),
        Waveform::Constant { level } => (level.abs(), file.limit),
        Waveform::Staircase { first, step, count, .. } => {
            let last = first + step * f64::from(count.saturating_sub(1));
            (first.abs().max(last.abs()), file.limit - ROUNDED)
        }
    }
}

/// Sets the amplitude of a profile; that of steps scales all of them.
pub fn set_amplitude(file: &mut ProfileFile, value: f64) {
    let (before, _) = amplitude(file);
    match &mut file.waveform {
        Waveform::Sine { amplitude, .. }
        | Waveform::Triangle { amplitude, .. }
        | Waveform::Chirp { amplitude, .. }
        | Waveform::Prbs { amplitude, .. }
        | Waveform::Multisine { amplitude, .. } => *amplitude = value,
        Waveform::Constant { level } => *level = value.copysign(*level),
        Waveform::Staircase { first, step, .. } if before > 0.0 => {
            (*first, *step) = (*first * value / before, *step * value / before);
        }
        // Steps between zeros have no form to scale.
        Waveform::Staircase { .. } => {}
    }
}

/// The settings with their history.
#[derive(Debug, Clone, Default)]
pub struct Signal {
    /// Settings of the panel.
    pub settings: Settings,
    /// What a new signal begins with.
    first: Settings,
    undone: Vec<Settings>,
    done: Vec<Settings>,
    /// Note on what was limited last.
    pub note: Option<String>,
}

/// Steps that can be undone.
const REMEMBERED: usize = 100;

impl Signal {
    /// A signal that begins with these settings.
    #[must_use]
    pub fn of(first: Settings) -> Self {
        Self { settings: first.clone(), first, ..Self::default() }
    }

    /// Begins a new signal; that can be undone.
    pub fn renew(&mut self) {
        self.change(self.first.clone());
    }

    /// Changes the settings within the limits; the change can be undone.
    pub fn change(&mut self, mut settings: Settings) {
        let note = settings.limit();
        settings.keep_duration(&self.settings);
        if settings != self.settings {
            self.done.push(std::mem::replace(&mut self.settings, settings));
            if self.done.len() > REMEMBERED {
                self.done.remove(0);
            }
            self.undone.clear();
            self.note = note;
        } else if note.is_some() {
            self.note = note;
        }
    }

    /// Loads a profile; a sine or a constant within the limits is shown in the panel's own fields.
    ///
    /// # Errors
    /// When a board would refuse the profile; one sentence.
    pub fn take(&mut self, file: &ProfileFile) -> Result<(), String> {
        file.profile(1000).map_err(|error| error.to_string())?;
        // An opened profile has a duration of its own.
        let mut settings =
            Settings { duration_s: file.duration_s, chosen_duration_s: None, ..self.settings.clone() };
        settings.kind = match file.waveform {
            Waveform::Sine { offset, amplitude, frequency_hz, periods: None }
                if file.command == ProfileCommand::Voltage =>
            {
                (settings.offset_v, settings.amplitude_v, settings.frequency_hz) =
                    (offset, amplitude, frequency_hz);
                SignalShape::Sine
            }
            Waveform::Constant { level } if file.command == ProfileCommand::Voltage => {
                settings.level_v = level;
                SignalShape::Constant
            }
            _ => SignalShape::Other("opened profile".into(), file.clone()),
        };
        let mut limited = settings.clone();
        if limited.limit().is_some() {
            settings = Settings {
                kind: SignalShape::Other("opened profile".into(), file.clone()),
                chosen_duration_s: None,
                ..self.settings.clone()
            };
        }
        self.change(settings);
        Ok(())
    }

    /// Loads a built-in profile.
    ///
    /// # Errors
    /// When there is none of that name.
    pub fn take_built_in(&mut self, name: &str) -> Result<(), String> {
        let file = ProfileFile::open(name).map_err(|error| error.to_string())?;
        self.change(Settings { kind: SignalShape::Other(name.into(), file), ..self.settings.clone() });
        Ok(())
    }

    /// Undo.
    pub fn undo(&mut self) {
        if let Some(before) = self.done.pop() {
            self.undone.push(std::mem::replace(&mut self.settings, before));
            self.note = None;
        }
    }

    /// Redo.
    pub fn redo(&mut self) {
        if let Some(after) = self.undone.pop() {
            self.done.push(std::mem::replace(&mut self.settings, after));
        }
    }

    /// Whether there is a step to undo and a step to redo.
    #[must_use]
    pub fn history(&self) -> [bool; 2] {
        [!self.done.is_empty(), !self.undone.is_empty()]
    }

    /// The signal as text, for the clipboard and for files.
    #[must_use]
    pub fn text(&self) -> String {
        self.settings.file().to_toml()
    }

    /// Replaces the signal by one that is read from text.
    ///
    /// # Errors
    /// When it is no profile; one sentence.
    pub fn paste(&mut self, text: &str) -> Result<(), String> {
        let file = ProfileFile::parse(text)
            .map_err(|error| format!("what was pasted is no input signal: {error}"))?;
        self.take(&file)
    }
}

/// Points of time in s and command in V (or rad/s), or an error.
pub type Preview = Result<Vec<[f64; 2]>, String>;

/// The command over time as the board will output it: points of time in s and command in V (or rad/s), about `2 * points` of them.
///
/// # Errors
/// When a board would refuse the profile; one sentence.
pub fn preview(file: &ProfileFile, points: usize) -> Preview {
    const PERIOD_US: u32 = 1000;
    let profile = file.sampled(PERIOD_US).map_err(|error| error.to_string())?;
    let mut generator = socam_core::Generator::new(&profile, PERIOD_US).map_err(|error| error.to_string())?;
    let ticks = ((file.duration_s + file.ramp_s) * 1e6 / f64::from(PERIOD_US)) as usize;
    let block = ticks.div_ceil(points.max(1)).max(1);
    let mut line = Vec::new();
    let mut extremes: Option<[f64; 2]> = None;
    for tick in 0..=ticks {
        let setpoint = generator.step();
        let value = f64::from(setpoint.value_micro) * 1e-6;
        extremes = Some(extremes.map_or([value; 2], |[low, high]| [value.min(low), value.max(high)]));
        if tick % block == 0 || setpoint.finished {
            let time_s = tick as f64 * f64::from(PERIOD_US) * 1e-6;
            line.extend(extremes.take().into_iter().flatten().map(|value| [time_s, value]));
        }
        if setpoint.finished {
            break;
        }
    }
    Ok(line)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Amplitude and duration of built-in profiles are set within what a board accepts.
    #[test]
    fn a_profile_takes_another_amplitude_and_duration() {
        let mut signal = Signal::default();
        signal.take_built_in("multisine").unwrap();
        let SignalShape::Other(_, mut file) = signal.settings.kind.clone() else { panic!() };
        let (before, most) = amplitude(&file);
        assert!(0.0 < before && before <= most, "{before} {most}");
        set_amplitude(&mut file, 0.5 * before);
        file.duration_s = 40.0;
        let line = preview(&file, 100).unwrap();
        let largest = |line: &[[f64; 2]]| line.iter().map(|point| point[1].abs()).fold(0.0, f64::max);
        assert!(line.last().unwrap()[0] > 39.0 && largest(&line) <= file.limit, "{line:?}");
        assert_eq!(amplitude(&file).0, 0.5 * before);
        signal.take_built_in("steps").unwrap();
        let SignalShape::Other(_, mut steps) = signal.settings.kind.clone() else { panic!() };
        let (before, most) = amplitude(&steps);
        assert!((before - 1.7).abs() < 1e-12 && (most - 1.8).abs() <= ROUNDED * 1.01, "{before} {most}");
        set_amplitude(&mut steps, 0.5 * before);
        assert!((amplitude(&steps).0 - 0.85).abs() < 1e-12);
        let line = preview(&steps, 100).unwrap();
        assert!((largest(&line) - 0.85).abs() < 0.01, "{}", largest(&line));
    }

    #[test]
    fn a_duration_that_was_chosen_stays_with_the_next_signal() {
        let mut signal = Signal::default();
        signal.take_built_in("multisine").unwrap();
        assert_eq!(signal.settings.length_s(), 20.0, "its own");
        let SignalShape::Other(name, mut file) = signal.settings.kind.clone() else { panic!() };
        file.duration_s = 40.0;
        signal.change(Settings { kind: SignalShape::Other(name, file), ..signal.settings.clone() });
        signal.take_built_in("prbs").unwrap();
        assert_eq!(signal.settings.length_s(), 40.0);
        signal.change(Settings { kind: SignalShape::Sine, ..signal.settings.clone() });
        assert_eq!(signal.settings.length_s(), 40.0);
        signal.change(Settings { duration_s: 5.0, ..signal.settings.clone() });
        signal.take_built_in("steps").unwrap();
        assert_eq!(signal.settings.length_s(), 5.0);
        // A file that is opened states its own.
        signal.take(&ProfileFile::open("chirp").unwrap()).unwrap();
        assert_eq!(signal.settings.length_s(), 20.0);
        (0..3).for_each(|_| signal.undo());
        assert_eq!((&signal.settings.kind, signal.settings.length_s()), (&SignalShape::Sine, 40.0));
    }

    #[test]
    fn limits_are_enforced_and_said() {
        let mut signal = Signal::default();
        signal.change(Settings { amplitude_v: 9.0, ..Settings::default() });
        assert_eq!(signal.settings.amplitude_v, 2.3);
        assert!(signal.settings.offset_v.abs() + signal.settings.amplitude_v <= LIMIT_V);
        assert!(signal.note.as_ref().unwrap().contains("amplitude 9 V"), "{:?}", signal.note);
        signal.change(Settings { frequency_hz: f64::NAN, ..Settings::default() });
        assert_eq!(signal.settings.frequency_hz, 0.05);
        for kind in [SignalShape::Sine, SignalShape::Constant] {
            let file = Settings { kind, ..signal.settings.clone() }.file();
            file.profile(1000).unwrap();
        }
    }

    #[test]
    fn a_signal_goes_through_the_clipboard_and_back_and_forth() {
        let mut signal = Signal::default();
        signal.change(Settings { frequency_hz: 2.5, ..Settings::default() });
        let text = signal.text();
        signal.undo();
        assert_eq!(signal.settings.frequency_hz, 1.0);
        signal.redo();
        assert_eq!(signal.settings.frequency_hz, 2.5);
        signal.take_built_in("multisine").unwrap();
        assert!(matches!(&signal.settings.kind, SignalShape::Other(name, _) if name == "multisine"));
        signal.paste(&text).unwrap();
        assert_eq!((signal.settings.kind.clone(), signal.settings.frequency_hz), (SignalShape::Sine, 2.5));
        assert!(signal.paste("nonsense").unwrap_err().contains("no input signal"));
    }

    #[test]
    fn every_built_in_profile_has_a_preview_within_its_limit() {
        for name in ProfileFile::built_in_names() {
            let file = ProfileFile::open(name).unwrap();
            let line = preview(&file, 400).unwrap();
            assert!(line.len() > 100, "{name}");
            assert!(line.iter().all(|[_, value]| value.abs() <= file.limit + 1e-9), "{name}");
        }
    }
}
