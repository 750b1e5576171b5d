//! Provenance of a report: the command as it was typed, the date, and the hashes of the files that were read.

use anyhow::Context;
use socam_job::options::quoted;
use socam_model::Model;
use socam_recording::Selection;
use socam_report::{FileHash, Provenance};

/// The provenance of a report of `model`, which `--model` calls `name`, and of recordings.
pub(crate) fn of<'a>(
    name: &str,
    model: &Model,
    runs: impl IntoIterator<Item = &'a String>,
) -> anyhow::Result<Provenance> {
    let mut files = vec![FileHash::of_content(name, model.text.as_bytes())];
    for run in runs {
        let selection = Selection::parse(run)?;
        // A pipe can be read only once, and was read already.
        for path in selection.files().filter(|path| path.is_file()) {
            let name = if selection.more.is_empty() { run.clone() } else { path.display().to_string() };
            let hash =
                FileHash::of_file(&name, path).with_context(|| format!("cannot read `{name}` again"))?;
            files.push(hash);
        }
    }
    let words = std::env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy()));
    let command = std::iter::once("socam-host".to_owned()).chain(words).collect::<Vec<_>>().join(" ");
    Ok(Provenance { command, date: now(), files })
}

fn now() -> String {
    jiff::Timestamp::now().strftime("%Y-%m-%d %H:%M UTC").to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.csv");
        std::fs::write(&path, "abc").unwrap();
        let run = format!("{}@0..1", path.display());
        let model = Model::builtin("two-mass").unwrap();
        let made = of("two-mass", &model, [&run]).unwrap();
        let names: Vec<_> = made.files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names, ["two-mass", run.as_str()]);
        // The SHA-256 of "abc" (FIPS 180-4, example B.1).
        assert!(made.files[1].sha256.starts_with("ba7816bf8f01cfea414140de5dae2223"));
        assert!(made.date.ends_with(" UTC") && made.command.starts_with("socam-host"));
    }
}
