//! Columns of the recordings that the model does not read.

use socam_model::Model;
use socam_recording::Dataset;

/// Largest number of columns that are named.
const MOST: usize = 5;

/// A sentence about columns of a recording that vary and that no channel of the model reads: physics that depends on one of them is found
/// as a curve at best. `None` where there is no such column.
pub(super) fn sentence(model: &Model, recording: &Dataset) -> Option<String> {
    let read: Vec<usize> =
        model.channels.iter().filter_map(|channel| recording.channel_index(&channel.column).ok()).collect();
    let columns = recording.channels().iter().zip(recording.statistics()).enumerate();
    let unread = columns.filter(|(index, (_, of))| !read.contains(index) && of.min < of.max);
    let names: Vec<String> = unread.map(|(_, (channel, _))| format!("`{}`", channel.column_name())).collect();
    let shown = names[..names.len().min(MOST)].join(", ");
    let rest = match names.len().saturating_sub(MOST) {
        0 => String::new(),
        rest => format!(" and {rest} more"),
    };
    (!names.is_empty()).then(|| {
        format!(
            "the model reads no channel from {shown}{rest}: physics that depends on such a column has no name here; with it as an input \
             channel of the model file, a law of your own can use it"
        )
    })
}

#[cfg(test)]
mod tests {
    use socam_recording::{Channel, Unit};

    use super::*;

    #[test]
    fn columns_that_vary_and_are_not_read_are_named() {
        let model = Model::builtin("emps").unwrap();
        let recording = |press: [f64; 2]| {
            let channels = [("force", Unit::N), ("position", Unit::M), ("press", Unit::N)];
            let channels = channels.map(|(name, unit)| Channel::new(name, unit)).to_vec();
            let values = vec![vec![0.0, 1.0], vec![0.0, 1.0], press.to_vec()];
            Dataset::from_columns("axis", channels, vec![0.0, 0.1], values).unwrap()
        };
        assert_eq!(sentence(&model, &recording([2.0, 2.0])), None);
        let told = sentence(&model, &recording([1.0, 2.0])).unwrap();
        assert!(told.starts_with("the model reads no channel from `press_N`: "), "{told}");
    }
}
