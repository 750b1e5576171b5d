//! Search of recordings for saturated outputs, failed reads of outputs, computed speeds and spikes of inputs, before any fit.

use std::sync::Arc;

use socam_model::Channel;
use socam_recording::{Dataset, check};

use crate::{
    IdentifyError,
    preprocessing::{
        computed,
        mask::{LeftOut, Mask, Reason, Rows, joined},
        segments::Segment,
        spikes,
    },
};

/// Rows on either side of a saturated range that are left out with it: near the limit only those samples are recorded whose noise keeps
/// them below it, and their mean is too low.
const BESIDE_SATURATION: u64 = 3;

/// Searches all recordings for saturated outputs, failed reads of outputs, computed speeds and spikes of inputs, sets the masks of their segments, and returns
/// the reports.
pub(crate) fn find(
    inputs: &[&Channel],
    outputs: &[&Channel],
    datasets: &[Dataset],
    segments: &mut [Segment],
) -> Result<Vec<LeftOut>, IdentifyError> {
    let mut notes = Vec::new();
    for (recording, dataset) in datasets.iter().enumerate() {
        let mut mask = Mask::default();
        for (output, rows) in saturated(outputs, dataset)? {
            notes.extend(LeftOut::new(dataset, &outputs[output].name, Reason::Saturated, &rows));
            mask.add(output, rows);
        }
        let own = || segments.iter().filter(|segment| segment.recording == recording);
        for (output, channel) in outputs.iter().enumerate() {
            let rows = spikes::failed_reads(channel, dataset, &own().collect::<Vec<_>>())?;
            let rows = joined(rows.into_iter().map(|row| row..row + 1).collect());
            notes.extend(LeftOut::new(dataset, &channel.name, Reason::Outliers, &rows));
            mask.add(output, rows);
        }
        for output in computed::find(outputs, dataset, &own().collect::<Vec<_>>(), &mask)? {
            let rows: Rows = std::iter::once(0..dataset.rows()).collect();
            notes.extend(LeftOut::new(dataset, &outputs[output].name, Reason::Computed, &rows));
            mask.add(output, rows);
        }
        mask.imputed = spikes::find(inputs, dataset, &own().collect::<Vec<_>>())?;
        for (imputed, channel) in mask.imputed.iter().zip(inputs) {
            let rows = joined(imputed.iter().map(|(row, _)| *row..row + 1).collect());
            notes.extend(LeftOut::new(dataset, &channel.name, Reason::Imputed, &rows));
        }
        let mask = Arc::new(mask);
        let own = segments.iter_mut().filter(|segment| segment.recording == recording);
        own.for_each(|segment| segment.mask = Arc::clone(&mask));
    }
    Ok(notes)
}

/// Outputs that are saturated, and the rows at which they are.
fn saturated(outputs: &[&Channel], dataset: &Dataset) -> Result<Vec<(usize, Rows)>, IdentifyError> {
    let columns = outputs.iter().map(|channel| dataset.channel_index(&channel.column));
    let columns = columns.collect::<Result<Vec<_>, _>>()?;
    let mut all = Vec::new();
    for found in check::saturations(dataset, &columns)? {
        let wider = found.rows.iter().map(|rows| {
            rows.start.saturating_sub(BESIDE_SATURATION)..(rows.end + BESIDE_SATURATION).min(dataset.rows())
        });
        let reading = columns.iter().enumerate().filter(|(_, column)| **column == found.channel);
        for (output, _) in reading {
            all.push((output, joined(wider.clone().collect())));
        }
    }
    Ok(all)
}
