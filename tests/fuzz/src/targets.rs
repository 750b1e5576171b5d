//! The parsers, and what must hold of each beside that it ends without a panic.

use std::path::Path;

use socam_calibrate::Pairs;
use socam_core::MAX_CHANNELS;
use socam_import::Mapping;
use socam_model::Model;
use socam_recording::{
    Calibration, Dataset, LegacyLog, ProfileFile, Recovered, Selection, Steady, read_attachments, recover,
};
use socam_workbench::document;

use crate::{Input, Target, damage, devices, links, seeds, topics};

/// Most values of a recording that are loaded: a file of a few hundred bytes may rightly hold more samples than are worth reading.
const MOST_VALUES: u64 = 1 << 20;
/// Sample time of the board that a profile is made for, us.
const SAMPLE_PERIOD_US: u32 = 1000;

/// All parsers.
pub const TARGETS: [Target; 24] = [
    Target { name: "log", extension: "mcap", parse: log, seeds: seeds::logs },
    Target { name: "damaged-log", extension: "bin", parse: damage::damaged, seeds: damage::recipes },
    Target { name: "csv", extension: "csv", parse: csv, seeds: seeds::tables },
    Target { name: "steady", extension: "csv", parse: steady, seeds: seeds::steady_states },
    Target { name: "foreign", extension: "bin", parse: foreign, seeds: seeds::foreign },
    Target { name: "foreign-table", extension: "csv", parse: foreign, seeds: seeds::foreign_tables },
    Target { name: "dbc", extension: "dbc", parse: dbc, seeds: seeds::databases },
    Target { name: "mapping", extension: "toml", parse: mapping, seeds: seeds::mappings },
    Target { name: "legacy", extension: "m", parse: legacy, seeds: seeds::legacy_logs },
    Target { name: "pairs", extension: "csv", parse: pairs, seeds: seeds::pairs },
    Target { name: "model", extension: "toml", parse: model, seeds: seeds::models },
    Target { name: "profile", extension: "toml", parse: profile, seeds: seeds::profiles },
    Target { name: "calibration", extension: "toml", parse: calibration, seeds: seeds::calibrations },
    Target { name: "report", extension: "json", parse: report, seeds: seeds::reports },
    Target { name: "host-link", extension: "bin", parse: links::host_link, seeds: seeds::to_host },
    Target { name: "device-lines", extension: "bin", parse: devices::lines, seeds: devices::line_seeds },
    Target { name: "device-frames", extension: "bin", parse: devices::frames, seeds: devices::frame_seeds },
    Target { name: "slcan", extension: "bin", parse: devices::slcan, seeds: devices::slcan_seeds },
    Target {
        name: "can-drives",
        extension: "bin",
        parse: devices::can_drives,
        seeds: devices::can_drive_seeds,
    },
    Target { name: "objects", extension: "toml", parse: devices::objects, seeds: devices::object_seeds },
    Target { name: "drives", extension: "bin", parse: devices::drives, seeds: devices::drive_seeds },
    Target { name: "foxglove-server", extension: "bin", parse: topics::server, seeds: topics::server_seeds },
    Target { name: "foxglove-client", extension: "bin", parse: topics::client, seeds: topics::client_seeds },
    Target { name: "board-link", extension: "bin", parse: links::board_link, seeds: seeds::to_board },
];

/// A parser with defects, which shows that they are noticed; not one of [`TARGETS`].
pub(crate) const BROKEN: Target =
    Target { name: "broken", extension: "bin", parse: broken, seeds: |_| vec![b"a".to_vec()] };

/// Panics at a `p`, and takes 4 GB at an `m`.
fn broken(input: Input<'_>) -> bool {
    assert!(!input.bytes.contains(&b'p'), "a defect");
    let taken = if input.bytes.contains(&b'm') { 4_000_000_000 } else { 1 };
    std::hint::black_box(vec![1_u8; taken]).len() == 1
}

/// Loads a recording that opened: every column has as many values as there are times.
fn load(data: &Dataset) -> bool {
    if data.rows().saturating_mul(data.channels().len() as u64 + 1) > MOST_VALUES {
        return true;
    }
    let Ok(loaded) = data.load_all() else { return false };
    let Ok(again) = data.load_all() else { panic!("a recording that was read is not read again") };
    for (first, second) in loaded.columns.iter().zip(&again.columns) {
        let is_same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
        assert!(first.values().iter().zip(second.values()).all(is_same), "a recording read twice");
    }
    let lengths = loaded.columns.iter().map(|column| column.values().len());
    assert!(lengths.chain([data.rows() as usize]).all(|length| length == loaded.time_s.len()));
    true
}

fn opened(path: &Path) -> Option<Dataset> {
    Dataset::open_selection(&Selection::whole(path)).ok()
}

/// What is recovered of a log opens, and holds as many samples as the log.
fn log(input: Input<'_>) -> bool {
    let _ = read_attachments(input.path);
    let Some(data) = opened(input.path) else { return false };
    let accepted = load(&data);
    let _ = data.contents();
    let target = input.path.with_extension("recovered.mcap");
    let _ = std::fs::remove_file(&target);
    if let Ok(Recovered { samples, .. }) = recover(input.path, &target) {
        let again = Dataset::open_selection(&Selection::whole(&target));
        let again = again.unwrap_or_else(|error| panic!("a recovered log does not open: {error}"));
        assert_eq!((again.rows(), samples), (data.rows(), data.rows()), "samples of the recovered log");
    }
    accepted
}

fn csv(input: Input<'_>) -> bool {
    opened(input.path).is_some_and(|data| load(&data))
}

/// What a file of another program proposes is a mapping once its units are known, and the file is read by it in the end or refused.
fn foreign(input: Input<'_>) -> bool {
    let dbc = input.path.with_extension("dbc");
    if !dbc.exists() && std::fs::write(&dbc, seeds::DBC).is_err() {
        return false;
    }
    let Ok(proposal) = socam_import::propose(input.path, Some(&dbc)) else { return false };
    let complete = proposal.text.replace("\"?\"", "\"1\"").replace("rate_Hz = \"1\"", "rate_Hz = 1");
    let complete = complete.replace("counts_per_turn = \"1\"", "counts_per_turn = 1");
    let mapping = Mapping::parse(&complete);
    let mapping = mapping.unwrap_or_else(|error| panic!("a proposal is no mapping: {error}\n{complete}"));
    let imported = socam_import::import(&Selection::whole(input.path), &mapping);
    imported.is_ok_and(|imported| load(&imported.data))
}

/// What a DBC finds in frames of every identifier that the seeds have.
fn dbc(input: Input<'_>) -> bool {
    let log = input.path.with_extension("log");
    let frames: String = (0..16).map(|row| format!("({row}) can0 101#{row:02X}00010203040506\n")).collect();
    if std::fs::write(&log, frames).is_err() {
        return false;
    }
    socam_import::propose(&log, Some(input.path)).is_ok()
}

fn mapping(input: Input<'_>) -> bool {
    std::str::from_utf8(input.bytes).is_ok_and(|text| Mapping::parse(text).is_ok())
}

/// Every row has a value or an empty cell for each channel.
fn steady(input: Input<'_>) -> bool {
    let Ok(table) = Steady::open(input.path) else { return false };
    assert!(table.rows.iter().all(|row| row.values.len() == table.channels.len()));
    true
}

fn legacy(input: Input<'_>) -> bool {
    let read = LegacyLog::read(input.path).is_ok();
    opened(input.path).is_some_and(|data| load(&data)) || read
}

fn pairs(input: Input<'_>) -> bool {
    std::str::from_utf8(input.bytes).is_ok_and(|text| Pairs::parse("pairs.csv".into(), text).is_ok())
}

/// A model that parses has equations of finite numbers at its values, or says why not, and a drawing.
fn model(input: Input<'_>) -> bool {
    let Some(model) = std::str::from_utf8(input.bytes).ok().and_then(|text| Model::parse(text).ok()) else {
        return false;
    };
    if let Ok(equations) = model.equations(&model.values()) {
        assert!(equations.state.iter().all(|value| !value.is_nan()), "state matrix");
    }
    let _ = socam_model::layout::Layout::of(&model);
    true
}

/// A profile that is written again reads equal.
fn profile(input: Input<'_>) -> bool {
    let parsed = std::str::from_utf8(input.bytes).ok().and_then(|text| ProfileFile::parse(text).ok());
    let Some(profile) = parsed else { return false };
    let again = ProfileFile::parse(&profile.to_toml());
    assert_eq!(again.as_ref().ok(), Some(&profile), "a profile that is written again: {again:?}");
    profile.profile(SAMPLE_PERIOD_US).is_ok()
}

/// A calibration that a board may get converts every count to a finite number.
fn calibration(input: Input<'_>) -> bool {
    let parsed = std::str::from_utf8(input.bytes).ok().and_then(|text| Calibration::parse(text).ok());
    let Some(calibration) = parsed.filter(|calibration| calibration.config(SAMPLE_PERIOD_US).is_ok()) else {
        return false;
    };
    for count in [i16::MIN, 0, i16::MAX] {
        assert!(
            calibration.values(count, &[count.into(); MAX_CHANNELS]).all(f64::is_finite),
            "value of {count}"
        );
    }
    true
}

/// What the dashboard opens: diagnoses, identifications, models and profiles.
fn report(input: Input<'_>) -> bool {
    std::str::from_utf8(input.bytes).is_ok_and(|text| document::parse("report.json", text).is_ok())
}
