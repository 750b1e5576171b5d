//! Recordings in full precision, as a fit takes them.

use socam_job::Grid;
use socam_recording::Dataset;

use socam_workbench::job::Handle;
use socam_workbench::recording::{Recording, short};

/// Reads recordings again, on a grid.
///
/// # Errors
/// When one cannot be read, or the job was cancelled; one sentence.
pub(crate) fn datasets(
    recordings: &[Recording],
    grid: Grid<'_>,
    handle: &Handle,
) -> Result<Vec<Dataset>, String> {
    let one = |recording: &Recording| {
        handle.doing(format!("reading {}", short(&recording.about.name)));
        handle.reached(0.0)?;
        grid.apply(recording.dataset()?).map_err(|error| error.to_string())
    };
    recordings.iter().map(one).collect()
}
