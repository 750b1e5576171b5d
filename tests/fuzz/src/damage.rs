//! Whole recordings that are damaged afterwards: no reader may give a sample that the recording does not hold.

use std::path::Path;
use std::sync::OnceLock;

use socam_recording::{Dataset, Selection, recover};

use crate::Input;
use crate::seeds;

/// Bytes of an input that say one damage: its kind, three of its place.
const STEP: usize = 4;
/// Most damages of one recording.
const MOST: usize = 6;
/// Bytes that a disk loses at a time.
const SECTOR: usize = 512;
/// Samples of the recording.
const ROWS: i64 = 400;

type Row = (f64, f64);

/// A recording with checksums, and its samples.
struct Whole {
    bytes: Vec<u8>,
    rows: Vec<Row>,
}

fn whole() -> &'static Whole {
    static WHOLE: OnceLock<Whole> = OnceLock::new();
    WHOLE.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder for a recording");
        let path = folder.path().join("whole.mcap");
        seeds::record(&path, ROWS).expect("a recording can be made");
        let bytes = std::fs::read(&path).expect("a recording can be read");
        Whole { bytes, rows: rows(&path).expect("a whole recording opens") }
    })
}

/// Times and speeds; `None` where the recording does not open.
fn rows(path: &Path) -> Option<Vec<Row>> {
    let loaded = Dataset::open_selection(&Selection::whole(path)).ok()?.load(&["motor_speed"]).ok()?;
    Some(loaded.time_s.iter().copied().zip(loaded.columns[0].values().iter().copied()).collect())
}

/// The damage that `recipe` says.
fn damage(bytes: &mut Vec<u8>, recipe: &[u8]) {
    let mut places = recipe[1..].iter().fold(0, |place, byte| place << 8 | usize::from(*byte));
    places %= bytes.len().max(1);
    let sector = places / SECTOR * SECTOR;
    let end = bytes.len().min(sector + SECTOR);
    match recipe[0] {
        kind @ 0..200 => {
            if let Some(byte) = bytes.get_mut(places) {
                *byte ^= 1 << (kind % 8);
            }
        }
        200..220 => bytes[sector..end].fill(0),
        220..235 => drop(bytes.drain(sector..end)),
        235..250 => {
            let copy = bytes[sector..end].to_vec();
            drop(bytes.splice(sector..sector, copy));
        }
        _ => bytes.truncate(places),
    }
}

/// An input is a list of damages. What the damaged recording, and what is recovered of it, still gives is what it held.
pub(crate) fn damaged(input: Input<'_>) -> bool {
    let whole = whole();
    let mut bytes = whole.bytes.clone();
    for recipe in input.bytes.chunks_exact(STEP).take(MOST) {
        damage(&mut bytes, recipe);
    }
    let path = input.path.with_extension("mcap");
    std::fs::write(&path, &bytes).expect("the damaged recording is written");
    let Some(read) = rows(&path) else { return false };
    for row in &read {
        let is_known = whole
            .rows
            .binary_search_by(|known| known.0.total_cmp(&row.0))
            .is_ok_and(|at| whole.rows[at] == *row);
        assert!(is_known, "a sample that was never recorded: {row:?}");
    }
    let clean = input.path.with_extension("recovered.mcap");
    let _ = std::fs::remove_file(&clean);
    if recover(&path, &clean).is_ok() {
        assert_eq!(rows(&clean).as_ref(), Some(&read), "samples of the recovered recording");
    }
    true
}

/// Lists of damages.
pub(crate) fn recipes(_: &Path) -> Vec<Vec<u8>> {
    let step = |kind: u8, place: u32| [&[kind][..], &place.to_be_bytes()[1..]].concat();
    let one = |kind| step(kind, 3000);
    let flips: Vec<u8> = (0..MOST as u32).flat_map(|k| step(k as u8, 1 + 700 * k)).collect();
    vec![Vec::new(), one(3), one(200), one(220), one(235), one(250), flips]
}
