//! The columns that a model reads, among those of a recording.

use socam_model::{Model, Quantity};
use socam_recording::{Channel, Dataset};

use crate::MonitorError;

/// The columns that a model reads, each once, and their indices among `channels`.
pub(crate) fn columns_of(
    model: &Model,
    channels: &[Channel],
) -> Result<(Vec<Channel>, Vec<usize>), MonitorError> {
    let mut indices: Vec<usize> = Vec::new();
    for channel in model.channels.iter().filter(|channel| channel.quantity != Quantity::Time) {
        let position = channels.iter().position(|known| known.column_name() == channel.column);
        let index = position.ok_or_else(|| {
            let held: Vec<String> = channels.iter().map(Channel::column_name).collect();
            MonitorError::Channel {
                model: model.name.clone(),
                column: channel.column.clone(),
                held: held.join(", "),
            }
        })?;
        if !indices.contains(&index) {
            indices.push(index);
        }
    }
    Ok((indices.iter().map(|index| channels[*index].clone()).collect(), indices))
}

/// Refuses models whose laws depend on the angle since the start of a recording: blocks begin at any angle.
pub(crate) fn check_clocks(model: &Model) -> Result<(), MonitorError> {
    let Some(channel) = model.inputs().find(|input| input.quantity == Quantity::Turned) else {
        return Ok(());
    };
    Err(MonitorError::Unsuited {
        model: model.name.clone(),
        why: format!(
            "an effect at {} depends on the angle since the start of the recording, which a block does not know; take that effect out",
            channel.at
        ),
    })
}

/// Calls `each` with the time and these columns of every row of a recording.
pub(crate) fn each_row(
    dataset: &Dataset,
    columns: &[usize],
    mut each: impl FnMut(f64, &mut dyn Iterator<Item = f64>) -> Result<(), MonitorError>,
) -> Result<(), MonitorError> {
    for block in dataset.blocks_in(0..dataset.rows(), columns)? {
        let block = block?;
        for (row, time_s) in block.time_s.iter().enumerate() {
            each(*time_s, &mut block.columns.iter().map(|column| column.values()[row]))?;
        }
    }
    Ok(())
}
