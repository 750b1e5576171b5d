//! What a drive that was commanded must have done.

use socam_recording::Dataset;

/// A recorded drive has followed its `command`, a sine of 10 rad/s: it was commanded all of it, and its `speed` is near that but for a twentieth of the rows.
///
/// # Panics
/// When it has not.
pub fn assert_follows(recording: &Dataset) {
    let data = recording.load(&["command", "speed"]).expect("command and speed are recorded");
    let [command, speed] = [0, 1].map(|column: usize| data.columns[column].values());
    let far = command.iter().zip(speed).filter(|(command, speed)| (*command - *speed).abs() > 4.0).count();
    assert!(
        command.iter().any(|value| *value > 9.8) && far * 20 < command.len(),
        "{far} of {}",
        command.len()
    );
}
