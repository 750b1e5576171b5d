//! Writes cases of the challenge as files: the recordings, the model that a diagnosis starts from, and the truth.
//!
//! `cargo run --release -p socam-sim --example challenge_case -- DIR SEED NUMBER..` makes DIR/case-NUMBER for each.

use std::path::Path;

use socam_recording::{Dataset, export_csv};
use socam_sim::challenge::Case;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut words = std::env::args().skip(1);
    let dir = words.next().ok_or("expected DIR SEED NUMBER..")?;
    let seed = words.next().ok_or("expected a seed after the folder")?.parse()?;
    for number in words {
        let case = Case::draw(seed, number.parse()?)?;
        write(&case, &Path::new(&dir).join(format!("case-{number}")))?;
        println!("{number} {} {:?} {:?}", case.machine.family, case.kind, case.hidden);
    }
    Ok(())
}

fn write(case: &Case, dir: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(dir)?;
    std::fs::write(dir.join("model.toml"), &case.base()?.text)?;
    std::fs::write(dir.join("truth.toml"), toml::to_string(case)?)?;
    let recorded = case.record()?;
    let all = |what: &str, data: &[Dataset]| {
        let mut each = data.iter().enumerate();
        each.try_for_each(|(index, data)| export_csv(data, &dir.join(format!("{what}-{}.csv", index + 1))))
    };
    all("training", &recorded.training)?;
    all("holdout", &recorded.holdout)?;
    Ok(())
}
