//! The contents of a recording.

use std::path::Path;

use serde::Serialize;
use socam_import::{FileFormat, Opened, open_either};
use socam_recording::{
    Cut, Dataset, Format, LogContents, Segment, Selection, Statistics, Steady, Unit, Warning, detect,
};

/// The contents of one recording. The names are part of the JSON document.
#[derive(Serialize)]
pub(super) struct Info {
    pub(super) recording: String,
    pub(super) format: Format,
    /// The format of a file of another program, whose channels are in memory.
    #[serde(skip)]
    pub(super) foreign: Option<FileFormat>,
    pub(super) rows: u64,
    pub(super) start_s: Option<f64>,
    pub(super) end_s: Option<f64>,
    /// First and last time by the clock that stamped the rows.
    pub(super) clock: Option<[String; 2]>,
    pub(super) duration_s: Option<f64>,
    pub(super) sample_time_s: Option<f64>,
    pub(super) rate_hz: Option<f64>,
    pub(super) channels: Vec<ChannelInfo>,
    pub(super) segments: Vec<Segment>,
    pub(super) gaps: Vec<Gap>,
    pub(super) lost_samples: Option<u64>,
    pub(super) cut: Option<Cut>,
    #[serde(skip)]
    pub(super) is_complete: bool,
    pub(super) log: Option<LogContents>,
    pub(super) warnings: Vec<String>,
}

#[derive(Serialize)]
pub(super) struct ChannelInfo {
    pub(super) name: String,
    pub(super) unit: Unit,
    #[serde(flatten)]
    pub(super) statistics: Option<Statistics>,
}

#[derive(Serialize)]
pub(super) struct Gap {
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    /// Number of missing rows.
    pub(super) rows: u64,
}

/// Reads one recording; the frames of a CAN bus by a DBC.
pub(super) fn info(run: &str, dbc: Option<&Path>) -> anyhow::Result<Info> {
    let selection = Selection::parse(run)?;
    let path = &selection.path;
    // Errors of unreadable files are raised where every command opens its files.
    if detect(path).is_ok_and(|format| format == Format::SteadyStates) {
        return Ok(Info::of_steady(&Steady::open(path)?));
    }
    Ok(match open_either(&selection, dbc)? {
        Opened::Own(data) => Info::of(&data),
        Opened::Foreign(imported) => {
            Info { foreign: socam_import::detect(path).ok(), ..Info::of(&imported.data) }
        }
    })
}

/// Whether the report shows the content of a warning elsewhere.
fn is_said_elsewhere(warning: &Warning) -> bool {
    matches!(warning, Warning::CutOff { .. } | Warning::LostSamples { .. })
}

impl Info {
    fn of(data: &Dataset) -> Self {
        let sample_time_s = Some(data.sample_time_s()).filter(|s| *s > 0.0);
        let gap = |pair: &[Segment]| Gap {
            from_s: pair[0].end_s,
            to_s: pair[1].start_s,
            rows: ((pair[1].start_s - pair[0].end_s) / data.sample_time_s()).round() as u64 - 1,
        };
        Self {
            recording: data.name().into(),
            format: data.format(),
            foreign: None,
            rows: data.rows(),
            start_s: Some(data.start_s()),
            end_s: Some(data.end_s()),
            clock: data
                .epoch()
                .map(|epoch| [data.start_s(), data.end_s()].map(|time_s| epoch.clock_time(time_s))),
            duration_s: Some(data.end_s() - data.start_s()),
            sample_time_s,
            rate_hz: sample_time_s.map(|s| 1.0 / s),
            channels: data
                .channels()
                .iter()
                .zip(data.statistics())
                .map(|(channel, statistics)| ChannelInfo {
                    name: channel.name.clone(),
                    unit: channel.unit,
                    statistics: Some(*statistics),
                })
                .collect(),
            segments: data.segments().to_vec(),
            gaps: data.segments().windows(2).map(gap).collect(),
            lost_samples: (data.format() == Format::Mcap).then(|| data.lost_samples()),
            cut: data.cut().cloned(),
            is_complete: data.is_complete(),
            log: data.contents().cloned(),
            warnings: data
                .warnings()
                .iter()
                .filter(|warning| !is_said_elsewhere(warning))
                .map(ToString::to_string)
                .collect(),
        }
    }

    fn of_steady(steady: &Steady) -> Self {
        Self {
            recording: steady.name.clone(),
            format: Format::SteadyStates,
            foreign: None,
            rows: steady.rows.len() as u64,
            start_s: None,
            end_s: None,
            clock: None,
            duration_s: None,
            sample_time_s: None,
            rate_hz: None,
            channels: steady
                .channels
                .iter()
                .map(|channel| ChannelInfo {
                    name: channel.name.clone(),
                    unit: channel.unit,
                    statistics: None,
                })
                .collect(),
            segments: Vec::new(),
            gaps: Vec::new(),
            lost_samples: None,
            cut: None,
            is_complete: true,
            log: None,
            warnings: steady.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}
