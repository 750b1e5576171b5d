//! Many recordings on several cores, each on one thread.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

use rayon::prelude::*;
use socam_diagnose::Frozen;
use socam_job::Grid;
use socam_model::Model;
use socam_recording::Selection;

use crate::error::{FleetError, Result};
use crate::one::diagnose_one;
use crate::options::FleetOptions;
use crate::part::Part;
use crate::row::Row;
use crate::source::Source;

/// Receives the progress of a run, and can stop it.
pub trait Observer: Sync {
    /// A recording is done; `known` says that its row was in the part file already.
    fn done(&self, recording: &str, known: bool);
    /// Whether to end after the recordings that are begun.
    fn stops(&self) -> bool;
}

/// Diagnoses recordings with `workers` threads and appends their rows to the part file. Recordings whose row is already in the part
/// file are skipped. Returns the ids of all recordings, in the order of `sources`; `None` if the run was stopped before its end.
///
/// # Errors
/// When the part file cannot be written.
pub fn run(
    sources: &[Source],
    (model, options, seed): (&Model, &FleetOptions, u64),
    workers: usize,
    part: &mut Part,
    observer: &dyn Observer,
) -> Result<Option<Vec<String>>> {
    let next = AtomicUsize::new(0);
    let mut ids: Vec<Option<String>> = vec![None; sources.len()];
    let known = |part: &Part, source: &Source| {
        let id = source.id(model, options, seed).ok()?;
        part.holds(&source.name, &id).then_some(id)
    };
    let mut todo = Vec::new();
    for (index, source) in sources.iter().enumerate() {
        ids[index] = if part.is_empty() { None } else { known(part, source) };
        if ids[index].is_some() {
            observer.done(&source.name, true);
        } else {
            todo.push(index);
        }
        if observer.stops() {
            return Ok(None);
        }
    }
    std::thread::scope(|scope| {
        let (sender, rows) = mpsc::sync_channel::<(usize, Row)>(workers);
        for _ in 0..workers.max(1) {
            let (sender, next, todo) = (sender.clone(), &next, &todo);
            scope.spawn(move || {
                while let Some(index) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let row = diagnose_one(&sources[*index], model, options, seed);
                    if sender.send((*index, row)).is_err() || observer.stops() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        for (index, row) in rows {
            part.append(&row)?;
            observer.done(&row.recording, false);
            ids[index] = Some(row.id);
        }
        Ok::<(), FleetError>(())
    })?;
    Ok(ids.into_iter().collect())
}

/// Noise reference from healthy recordings, with which all other recordings are screened: the median over the recordings, each of
/// which is fitted alone because healthy machines differ. `None` if `sources` is empty.
///
/// # Errors
/// [`FleetError::Reference`] for the first recording that cannot be used.
pub fn reference(
    sources: &[Source],
    (model, options, seed): (&Model, &FleetOptions, u64),
) -> Result<Option<Frozen>> {
    let each = sources.par_iter().map(|source| {
        let wrong = |message: String| FleetError::Reference { recording: source.name.clone(), message };
        let opened = source.with_path(|path| {
            let data = socam_import::open_selection(&Selection::whole(path)).map_err(|e| e.to_string())?;
            Grid::Fit.apply(data).map_err(|e| e.to_string())
        });
        let data = opened.map_err(|e| wrong(e.to_string()))?.map_err(wrong)?;
        Frozen::of(model, &data, &options.diagnosis(seed)).map_err(|e| wrong(e.to_string()))
    });
    Ok(Frozen::median(&each.collect::<Result<Vec<Frozen>>>()?))
}
