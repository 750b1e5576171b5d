//! The parsers, and what must hold of each beside that it ends without a panic.

use std::path::Path;

use socam_calibrate::Pairs;
use socam_core::Ring;
use socam_dashboard::document;
use socam_model::Model;
use socam_recording::{
    Calibration, Dataset, LegacyLog, ProfileFile, Recovered, Selection, Steady, read_attachments, recover,
};
use socam_wire::{BoardLink, Decoder, MAX_FRAME, ToBoard, ToHost};

use crate::{Input, Target, seeds};

/// Most values of a recording that are loaded: a file of a few hundred bytes may rightly hold more samples than are worth reading.
const MOST_VALUES: u64 = 1 << 20;
/// Sample time of the board that a profile is made for, us.
const SAMPLE_PERIOD_US: u32 = 1000;

/// All parsers.
pub const TARGETS: [Target; 11] = [
    Target { name: "log", extension: "mcap", parse: log, seeds: seeds::logs },
    Target { name: "csv", extension: "csv", parse: csv, seeds: seeds::tables },
    Target { name: "steady", extension: "csv", parse: steady, seeds: seeds::steady_states },
    Target { name: "legacy", extension: "m", parse: legacy, seeds: seeds::legacy_logs },
    Target { name: "pairs", extension: "csv", parse: pairs, seeds: seeds::pairs },
    Target { name: "model", extension: "toml", parse: model, seeds: seeds::models },
    Target { name: "profile", extension: "toml", parse: profile, seeds: seeds::profiles },
    Target { name: "calibration", extension: "toml", parse: calibration, seeds: seeds::calibrations },
    Target { name: "report", extension: "json", parse: report, seeds: seeds::reports },
    Target { name: "host-link", extension: "bin", parse: host_link, seeds: seeds::to_host },
    Target { name: "board-link", extension: "bin", parse: board_link, seeds: seeds::to_board },
];

/// Loads a recording that opened: every column has as many values as there are times.
fn load(data: &Dataset) -> bool {
    if data.rows().saturating_mul(data.channels().len() as u64 + 1) > MOST_VALUES {
        return true;
    }
    let Ok(loaded) = data.load_all() else { return false };
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

fn profile(input: Input<'_>) -> bool {
    let parsed = std::str::from_utf8(input.bytes).ok().and_then(|text| ProfileFile::parse(text).ok());
    parsed.is_some_and(|profile| profile.profile(SAMPLE_PERIOD_US).is_ok())
}

fn calibration(input: Input<'_>) -> bool {
    std::str::from_utf8(input.bytes).is_ok_and(|text| Calibration::parse(text).is_ok())
}

/// What the dashboard opens: diagnoses, identifications, models and profiles.
fn report(input: Input<'_>) -> bool {
    std::str::from_utf8(input.bytes).is_ok_and(|text| document::parse("report.json", text).is_ok())
}

/// Messages do not depend on how the bytes arrive.
fn host_link(input: Input<'_>) -> bool {
    let messages = |pieces: std::slice::Chunks<'_, u8>| -> Vec<String> {
        let mut decoder = Decoder::<ToHost>::new();
        let mut all = Vec::new();
        for mut piece in pieces {
            all.extend(std::iter::from_fn(|| decoder.next(&mut piece)).map(|one| format!("{one:?}")));
        }
        all
    };
    let whole = messages(input.bytes.chunks(input.bytes.len().max(1)));
    assert_eq!(whole, messages(input.bytes.chunks(7)), "messages of whole and of divided bytes");
    whole.iter().any(|message| message.starts_with("Ok"))
}

/// The board answers each message once, however the bytes arrive.
fn board_link(input: Input<'_>) -> bool {
    let requests = |size: usize| -> Vec<String> {
        let mut ring = Ring::<16>::new();
        let (_, samples) = ring.split();
        let mut link = BoardLink::new(seeds::identity(), samples);
        let mut out = [0; MAX_FRAME];
        let mut all = Vec::new();
        for mut piece in input.bytes.chunks(size) {
            let mut asked = Vec::new();
            while let Some(length) = link.receive(&mut piece, &mut out, |request| {
                asked.push(format!("{request:?}"));
                Ok(())
            }) {
                let mut frame = &out[..length];
                let answer = Decoder::<ToHost>::new().next(&mut frame);
                assert!(matches!(answer, Some(Ok(ToHost::Hello(_) | ToHost::Answer { .. }))), "{answer:?}");
            }
            all.append(&mut asked);
        }
        all
    };
    let whole = requests(input.bytes.len().max(1));
    assert_eq!(whole, requests(5), "requests of whole and of divided bytes");
    let mut decoder = Decoder::<ToBoard>::new();
    let mut bytes = input.bytes;
    std::iter::from_fn(|| decoder.next(&mut bytes)).any(|one| one.is_ok())
}
