//! Output of all commands: results on stdout, messages on stderr, an error as one sentence.

use std::borrow::Cow;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use serde::Serialize;
use socam_job::{Grid, JobError};
use socam_recording::{Dataset, OutputFile, RecordingError, Selection};

/// Help of every argument that names recordings.
pub(crate) const RUNS_HELP: &str = "Recordings in any format that `import` reads, or parts of them: RUN@FROM..TO in seconds or clock times; wildcards in quotes; A+B joins files of one run";

/// Arguments that no command can work with; ends with exit code 2.
#[derive(Debug)]
pub(crate) struct WrongArguments(pub(crate) String);

impl std::fmt::Display for WrongArguments {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for WrongArguments {}

/// The reader of stdout has closed it (`| head`), which is not an error.
#[derive(Debug)]
struct NobodyListens;

impl std::fmt::Display for NobodyListens {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("nobody reads the output")
    }
}

impl std::error::Error for NobodyListens {}

/// Text in which control characters are written as `\u{1b}`: names of files, boards and models must not command the terminal.
fn printable(text: &str) -> Cow<'_, str> {
    let is_plain = |c: char| !c.is_control() || matches!(c, '\n' | '\t');
    if text.chars().all(is_plain) {
        return text.into();
    }
    let mut plain = String::new();
    for c in text.chars() {
        if is_plain(c) { plain.push(c) } else { plain.extend(c.escape_default()) }
    }
    plain.into()
}

/// Prints text to stdout.
pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    let text = printable(text);
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).map_err(|e| match e.kind() {
        io::ErrorKind::BrokenPipe => NobodyListens.into(),
        _ => anyhow::Error::new(e).context("cannot write to stdout"),
    })
}

/// Prints one JSON document to stdout.
pub(crate) fn print_json(document: &impl Serialize) -> anyhow::Result<()> {
    let mut text = serde_json::to_string_pretty(document)?;
    text.push('\n');
    print(&text)
}

/// Prints a message to stderr.
pub(crate) fn say(text: impl std::fmt::Display) {
    say_after("", text);
}

/// Prints a message after a coloured word.
fn say_after(word: &str, text: impl std::fmt::Display) {
    // If stderr is closed, the message is lost.
    let _ = writeln!(io::stderr().lock(), "{word}{}", printable(&text.to_string()));
}

/// Prints a warning to stderr.
pub(crate) fn warn(text: impl std::fmt::Display) {
    say_after(&painted("warning: ", "33"), text);
}

/// Names of recordings with their wildcards expanded, as shells do that do it.
pub(crate) fn expanded(runs: &[String]) -> Result<Vec<String>, RecordingError> {
    socam_recording::expand(runs)
}

/// Opens a recording (`RUN` or `RUN@FROM..TO`) and prints its warnings.
pub(crate) fn open(run: &str) -> anyhow::Result<Dataset> {
    let data = socam_import::open(run)?;
    say_warnings(run, &data);
    Ok(data)
}

/// Opens a recording for a task and prints its warnings.
pub(crate) fn open_on(grid: Grid<'_>, run: &str) -> Result<Dataset, JobError> {
    let data = grid.open(run)?;
    say_warnings(run, &data);
    Ok(data)
}

/// Opens several recordings for a task and prints their warnings.
pub(crate) fn open_all(grid: Grid<'_>, runs: &[String]) -> Result<Vec<Dataset>, JobError> {
    runs.iter().map(|run| open_on(grid, run)).collect()
}

/// Prints a recording's warnings.
pub(crate) fn say_warnings(run: &str, data: &Dataset) {
    for warning in data.warnings() {
        warn(format_args!("`{run}`: {warning}"));
    }
}

/// One output file takes one recording.
pub(crate) fn single_output(runs: &[String], output: Option<&Path>) -> Result<(), WrongArguments> {
    match output {
        Some(output) if runs.len() > 1 => Err(WrongArguments(format!(
            "{} recordings for one output `{}`; leave -o out to write each beside its recording",
            runs.len(),
            output.display()
        ))),
        _ => Ok(()),
    }
}

/// Refuses to write a conversion over its source, or over another file unless it may be replaced. An empty file may be replaced.
pub(crate) fn check_target(target: &Path, source: &Path, replace: bool) -> anyhow::Result<()> {
    let place = |path: &Path| path.canonicalize().ok();
    if place(target).is_some_and(|target| place(source) == Some(target)) {
        let problem =
            format!("`{}` would be written over itself; name another file with -o", target.display());
        return Err(WrongArguments(problem).into());
    }
    check_free(target, replace)
}

/// The same for a conversion of a recording, which may be in several files.
pub(crate) fn check_target_of(target: &Path, run: &Selection, replace: bool) -> anyhow::Result<()> {
    run.files().try_for_each(|source| check_target(target, source, replace))
}

/// Refuses to replace a file unless it may be replaced. An empty file may be.
pub(crate) fn check_free(target: &Path, replace: bool) -> anyhow::Result<()> {
    if !replace && target.metadata().is_ok_and(|there| there.is_file() && there.len() > 0) {
        anyhow::bail!("`{}` exists already; choose another name, or --force to replace it", target.display());
    }
    Ok(())
}

/// Prints in one sentence why a command failed, and returns its exit code.
pub(crate) fn report(error: &anyhow::Error) -> ExitCode {
    if nobody_listens(error) {
        return ExitCode::SUCCESS;
    }
    say_after(&painted("error: ", "31"), sentence(error));
    let wrong_arguments = error.is::<WrongArguments>()
        || error.downcast_ref().is_some_and(JobError::is_wrong_request)
        || matches!(
            error.downcast_ref(),
            Some(RecordingError::Selection { .. } | RecordingError::Pattern { .. })
        );
    ExitCode::from(if wrong_arguments { 2 } else { 1 })
}

/// Whether the reader of stdout has closed it, at any depth of the chain of causes.
fn nobody_listens(error: &anyhow::Error) -> bool {
    match error.downcast_ref() {
        Some(RecordingError::Io { source, .. }) => source.kind() == io::ErrorKind::BrokenPipe,
        _ => error.is::<NobodyListens>(),
    }
}

/// The chain of causes, each once.
fn sentence(error: &anyhow::Error) -> String {
    let mut sentence = String::new();
    for cause in error.chain() {
        let text = without_number(&cause.to_string().replace('\n', " "));
        // Many errors repeat their cause in their own words.
        if sentence.is_empty() {
            sentence = text;
        } else if !sentence.contains(&text) {
            sentence = format!("{sentence}: {text}");
        }
        // Messages of these errors already contain the system's message.
        if matches!(cause.downcast_ref(), Some(RecordingError::Io { .. })) {
            break;
        }
    }
    sentence
}

/// The system's words without its number, ` (os error 2)`.
fn without_number(text: &str) -> String {
    let number =
        text.split_once(" (os error ").and_then(|(before, rest)| Some((before, rest.split_once(')')?.1)));
    number.map_or_else(|| text.to_owned(), |(before, after)| format!("{before}{after}"))
}

fn painted(text: &str, colour: &str) -> String {
    let plain = std::env::var_os("NO_COLOR").is_some() || !io::stderr().is_terminal();
    if plain { text.into() } else { format!("\u{1b}[1;{colour}m{text}\u{1b}[0m") }
}

/// Files that pages have beside their pictures.
const PAGE_FILES: [&str; 10] = [
    "index.html",
    "diagnosis.json",
    "model.toml",
    "next.toml",
    "comparison.json",
    "thesis.json",
    "response.json",
    "response.csv",
    "transfer.json",
    "match.json",
];

/// Refuses to write a page into a folder that has a file of one, unless it may be replaced. Commands ask before they begin their work.
pub(crate) fn check_page(folder: Option<&Path>, replace: bool) -> anyhow::Result<()> {
    let mut files = folder.iter().flat_map(|folder| PAGE_FILES.map(|name| folder.join(name)));
    files.try_for_each(|file| check_free(&file, replace))
}

/// Creates a file of this program's own that appears complete or not at all. It never replaces a recording.
pub(crate) fn create(path: &Path) -> anyhow::Result<OutputFile> {
    create_new(path, true)
}

/// Creates a file that a user named; it appears complete or not at all. It replaces an existing file only if `replace` is set.
pub(crate) fn create_new(path: &Path, replace: bool) -> anyhow::Result<OutputFile> {
    if socam_recording::detect(path).is_ok() {
        let problem = format!("`{}` is a recording; name another file to write", path.display());
        return Err(WrongArguments(problem).into());
    }
    check_free(path, replace)?;
    Ok(OutputFile::create(path)?)
}

/// Writes a text file that appears complete or not at all.
pub(crate) fn write_whole(path: &Path, text: &str) -> anyhow::Result<()> {
    let mut file = create(path)?;
    file.write_all(text.as_bytes()).with_context(|| format!("cannot write `{}`", path.display()))?;
    Ok(file.commit()?)
}

/// Writes text files into a folder, which is created if there is none; each file appears complete or not at all. The last one is the page,
/// so that all files to which it links exist.
pub(crate) fn write_folder(folder: &Path, files: &[(String, String)]) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
    files.iter().try_for_each(|(name, text)| write_whole(&folder.join(name), text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        assert_eq!(printable("a\tb\n"), "a\tb\n");
        assert_eq!(printable("\u{1b}[2Jrun\r\u{9b}"), "\\u{1b}[2Jrun\\r\\u{9b}");
    }

    #[test]
    fn an_error_is_one_sentence_with_the_systems_reason() {
        let absent = || io::Error::from_raw_os_error(2);
        let error = anyhow::Error::new(absent()).context("cannot create the folder `x`");
        assert_eq!(sentence(&error), "cannot create the folder `x`: No such file or directory");
        assert_eq!(without_number("File too large (os error 27); it ends"), "File too large; it ends");
        let said = RecordingError::Io { path: "x".into(), action: "open", source: absent() };
        assert_eq!(sentence(&said.into()), "cannot open `x`: there is no such file; check the path");
    }
}
