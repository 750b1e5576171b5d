//! Data on which all views work, and requests of the views to the window.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use socam_model::Model;
use socam_recording::{Channel, ProfileCommand, ProfileFile};

use crate::connection::Connection;
use crate::device::{Stated, Wanted};
use crate::display_units::DisplayUnits;
use crate::drive_run::DriveRun;
use crate::entry::Entry;
use crate::input_signal::Signal;
use crate::job::Wake;
use crate::next_run::NextRun;
use crate::origin::{Origin, Origins};
use crate::purpose::Purpose;
use crate::queue::Batch;
use crate::rail::Rail;
use crate::recording::Recording;
use crate::setup::{Chosen, Setup};
use crate::spectrum_settings::SpectrumSettings;
use crate::view::View;
use crate::watch::WatchState;

/// Writes a folder of that name; an error is one sentence.
pub type WriteFolder = Box<dyn FnOnce(&Path) -> Result<(), String> + Send>;

/// Simulates a model with the inputs of a recording; an error is one sentence.
pub type Simulate = fn(&Model, &Recording) -> Result<Recording, String>;

/// Content that is saved once a place for it is chosen.
pub enum Content {
    /// A file.
    Bytes(Vec<u8>),
    /// The folder of a diagnosis' report.
    Report(WriteFolder),
}

impl std::fmt::Debug for Content {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Bytes(_) => "Bytes",
            Self::Report(_) => "Report",
        })
    }
}

/// Something that a view asks of the window; it is done after the view is drawn.
#[derive(Debug)]
pub enum Request {
    /// Show another view.
    Show(View),
    /// Ask which files to open.
    Ask,
    /// Connect to the virtual bench, and show it.
    VirtualBench,
    /// Open a file.
    Open(String),
    /// Ask for the names and units of the columns of an open recording's file.
    Columns(String),
    /// Save a small file; a page in a browser offers it for download.
    Save(PathBuf, Vec<u8>),
    /// Ask where to save something, with a name to propose; a page in a browser offers it for download.
    SaveAs(Purpose, String, Content),
    /// Fit this range of time, s, of each recording next, and show the set-up.
    FitRange([f64; 2]),
    /// Make a profile the input signal, and show it; a page in a browser, which has no bench, offers it for download.
    Signal(Box<ProfileFile>),
    /// Make a model the one that recordings are compared with.
    Model(Box<Model>),
    /// Mark an alarm in the recording that is being made, if one is.
    Alarm(String),
    /// Tell in every view that the bench has departed from its model, with a way to a diagnosis.
    Alarmed(Departure, String),
    /// Open what was recorded since a departure for a diagnosis.
    Diagnose(Departure),
    /// Show a remark.
    Say(String),
    /// Show an error.
    Warn(String),
}

/// When the device of the live view departed from its model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Number of the link, as [`Connection::number`] gives it.
    pub link: u64,
    /// Time since the link was opened, s.
    pub onset_s: f64,
}

/// Samples of the running bench that have arrived since the last pass.
#[derive(Debug, Default)]
pub struct Feed {
    /// Channels of the bench; empty while no bench is connected.
    pub channels: Arc<Vec<Channel>>,
    /// The samples, the oldest first.
    pub batches: Vec<Arc<Batch>>,
}

/// The open recordings, the model, and requests to the window.
#[derive(Debug)]
pub struct Workspace {
    /// The open recordings.
    pub entries: Vec<Entry>,
    model: Model,
    /// The models that were used before.
    models: Vec<Model>,
    /// Where models came from.
    pub origins: Origins,
    /// Set-up of the next identification or diagnosis.
    pub setup: Setup,
    /// Counts the models that have been set; results that depend on the model are kept with it.
    revision: u64,
    requests: Vec<Request>,
    /// Whether a bench can be reached from here: not from a page in a browser.
    pub has_bench: bool,
    /// The address of the device that is connected to next, as in [`crate::device::FORMS`].
    pub device: String,
    /// What is said of it beside its address.
    pub stated: Stated,
    /// The connection to the bench.
    pub bench: Connection,
    /// Samples of the running bench.
    pub feed: Feed,
    /// The input signal of the next run of a board.
    pub signal: Signal,
    /// The input signal and the limits of the next run of a drive.
    pub drive: DriveRun,
    /// The next run.
    pub next_run: NextRun,
    /// Files that were opened last, the latest first.
    pub recent: Vec<String>,
    /// The range of time that the view over time has in sight, s; `None` while it shows everything.
    pub in_sight: Option<[f64; 2]>,
    /// How spectra are made; part of the layout of the view over time.
    pub spectra: SpectrumSettings,
    /// Units in which channels are shown; part of the layout of the view over time.
    pub units: DisplayUnits,
    /// The state of the watch; `None` while nothing was watched.
    pub watch: Option<WatchState>,
    /// The verdicts of check, identification and diagnosis.
    pub rail: Rail,
    /// How a recording is simulated; `None` where there is no simulator, as in a browser.
    pub simulate: Option<Simulate>,
}

impl Workspace {
    /// Nothing is open; recordings are compared with `model`.
    #[must_use]
    pub fn new(model: Model) -> Self {
        Self {
            entries: Vec::new(),
            model,
            models: Vec::new(),
            origins: Origins::default(),
            setup: Setup::default(),
            revision: 0,
            requests: Vec::new(),
            has_bench: false,
            device: "sim".into(),
            stated: Stated::default(),
            bench: Connection::default(),
            feed: Feed::default(),
            signal: Signal::default(),
            drive: DriveRun::default(),
            next_run: NextRun::default(),
            recent: Vec::new(),
            in_sight: None,
            spectra: SpectrumSettings::default(),
            units: DisplayUnits::default(),
            watch: None,
            rail: Rail::default(),
            simulate: None,
        }
    }

    /// The model that recordings are compared with.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Number of the model: another one after it was replaced.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Replaces the model.
    pub fn set_model(&mut self, model: Model) {
        let before = std::mem::replace(&mut self.model, model);
        self.models.retain(|known| known.text != before.text && known.text != self.model.text);
        self.models.push(before);
        self.revision += 1;
    }

    /// Replaces the model by an edited one: the one before is not listed among those that were used.
    pub fn edit_model(&mut self, model: Model) {
        self.models.retain(|known| known.text != model.text);
        self.origins.note(&model, Origin::Change);
        self.model = model;
        self.revision += 1;
    }

    /// The models that were used in this window, the present one last.
    #[must_use]
    pub fn known_models(&self) -> Vec<Model> {
        self.models.iter().chain([&self.model]).cloned().collect()
    }

    /// Recordings and model that the next identification or diagnosis fits.
    ///
    /// # Errors
    /// Why nothing can be started; one sentence.
    pub fn chosen(&self) -> Result<Chosen, String> {
        self.setup.chosen(&self.entries, &self.model)
    }

    /// The recordings that are shown, with their numbers, which determine their colours.
    pub fn shown(&self) -> impl Iterator<Item = (usize, &Recording)> {
        self.entries.iter().filter(|entry| entry.shown).map(|entry| (entry.number, &entry.recording))
    }

    /// Opens the link to the device.
    pub fn connect(&mut self, wake: Wake) {
        let address = self.device.trim().to_owned();
        self.drive.connect(&address);
        let wanted = Wanted { address, stated: self.stated.clone(), rate_hz: self.next_run.rate_hz };
        self.bench.connect(wanted, wake);
    }

    /// Records the source that is connected.
    pub fn record(&mut self) {
        self.bench.record(self.next_run.path(), self.next_run.note.trim().to_owned());
    }

    /// The input signal of the next run of what is connected: of a drive in rad/s, else of a board.
    #[must_use]
    pub fn present_signal(&self) -> &Signal {
        if self.bench.offer().is_some() { &self.drive.signal } else { &self.signal }
    }

    /// The same, to be changed.
    pub fn present_signal_mut(&mut self) -> &mut Signal {
        if self.bench.offer().is_some() { &mut self.drive.signal } else { &mut self.signal }
    }

    /// Makes a built-in form the input signal of what is connected.
    ///
    /// # Errors
    /// When there is none of that name; one sentence.
    pub fn take_form(&mut self, name: &str) -> Result<(), String> {
        if self.bench.offer().is_some() { self.drive.choose(name) } else { self.signal.take_built_in(name) }
    }

    /// Takes an input signal from a file: one of speeds is also one for drives.
    ///
    /// # Errors
    /// When a board would refuse it; one sentence.
    pub fn take_signal(&mut self, file: &ProfileFile) -> Result<(), String> {
        let is_for_drives = file.command != ProfileCommand::Voltage;
        let is_drive = self.bench.offer().is_some();
        if is_drive && !is_for_drives {
            return Err(
                "that signal is in volts, and a drive takes speeds or torques: disconnect it first".into()
            );
        }
        if is_for_drives {
            self.drive.signal.take(file)?;
        }
        // A torque is for drives alone.
        if is_drive || file.command == ProfileCommand::Torque { Ok(()) } else { self.signal.take(file) }
    }

    /// Loads the input signal; all limits are watched then, and nothing moves.
    pub fn arm(&mut self) {
        let mut plan = self.next_run.plan(&self.present_signal().settings);
        plan.limits = self.bench.offer().and_then(|offer| self.drive.limits(offer.effort));
        self.bench.arm(plan);
    }

    /// Takes what the bench has sent since the last call.
    pub fn listen(&mut self) {
        self.bench.listen();
        let channels: &[Channel] =
            if self.bench.is_connected() { self.bench.buffer().channels() } else { &[] };
        if *self.feed.channels != channels {
            self.feed.channels = Arc::new(channels.to_vec());
        }
        self.feed.batches = self.bench.take_fresh();
    }

    /// Asks something of the window.
    pub fn request(&mut self, request: Request) {
        self.requests.push(request);
    }

    /// Requests since the last call.
    pub fn take_requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.requests)
    }
}
