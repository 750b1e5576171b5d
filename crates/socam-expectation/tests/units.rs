//! Units of a recording's columns, which the model and the recording list independently.

use socam_model::COLUMN_UNITS;
use socam_recording::Unit;

#[test]
fn model_and_recording_know_the_same_units() {
    assert_eq!(
        COLUMN_UNITS,
        Unit::ALL.map(|unit| (unit.suffix(), unit.symbol())),
        "make `COLUMN_UNITS` of crates/socam-model/src/file/channel.rs equal to `Unit::ALL` of crates/socam-recording/src/unit.rs"
    );
}
