//! A session: what a window shows, as a file. Recordings and results are named by their paths, relative to the file.

use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::arrangement::Arrangement;
use crate::view::View;

/// Schema of a session's file.
pub const SCHEMA: &str = "socam.session/1";

/// What a window shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Session {
    /// [`SCHEMA`].
    pub schema: String,
    /// The view that is shown.
    pub view: View,
    /// The open recordings.
    #[serde(default)]
    pub recordings: Vec<Named>,
    /// Results that are shown: paths of identifications, and of diagnoses or the folders of their reports.
    #[serde(default)]
    pub results: Vec<String>,
    /// The range of time in sight, s; all of it without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range_s: Option<[f64; 2]>,
    /// Cursors A and B, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cursors_s: Option<[f64; 2]>,
    /// The range of time that is fitted of each recording, s; all of it without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fit_range_s: Option<[f64; 2]>,
    /// Plots, hidden and derived channels, units.
    pub layout: Arrangement,
    /// Text of the model's file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
}

/// A recording of a session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Named {
    /// Its path, or `RUN@FROM..TO`.
    pub run: String,
    /// Whether it is drawn.
    #[serde(default = "yes")]
    pub shown: bool,
    /// Delay that is added to its times in the drawing, s.
    #[serde(default)]
    pub shift_s: f64,
    /// Notes that somebody added in the window.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<Note>,
}

/// A note on a moment of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Note {
    /// Time of the recording, s.
    pub time_s: f64,
    /// What somebody saw there.
    pub text: String,
}

fn yes() -> bool {
    true
}

impl Session {
    /// The file's text.
    #[must_use]
    pub fn text(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// The session with the paths of a file in this folder as paths of this computer.
    #[must_use]
    pub fn resolved(mut self, folder: &Path) -> Self {
        let whole = |path: &str| folder.join(path).display().to_string();
        let is_file = |path: &str| folder.join(path).exists();
        self.recordings.iter_mut().for_each(|own| own.run = each_file(&own.run, is_file, whole));
        self.results.iter_mut().for_each(|own| *own = whole(own.as_str()));
        self
    }

    /// Paths of recordings and results that are not there.
    #[must_use]
    pub fn missing(&self) -> Vec<String> {
        let runs = self.recordings.iter().map(|own| &own.run);
        runs.chain(&self.results).filter(|path| !is_there(path)).cloned().collect()
    }
}

/// Whether there is a file or folder of that path, or the files of a part of recordings.
#[must_use]
pub fn is_there(run: &str) -> bool {
    let selected = || socam_recording::Selection::parse(run);
    Path::new(run).exists() || selected().is_ok_and(|selection| selection.files().all(|path| path.exists()))
}

/// The name of a recording with the path of each of its files relative to a folder.
#[must_use]
pub fn relative_run(run: &str, folder: &Path) -> String {
    each_file(run, |path| Path::new(path).exists(), |path| relative(path, folder))
}

/// The name of a recording with another path of each of its files: `A+B@FROM..TO` has two.
fn each_file(run: &str, is_file: impl Fn(&str) -> bool, path: impl Fn(&str) -> String) -> String {
    let (files, part) = match run.rsplit_once('@') {
        Some((files, span)) if span.contains("..") && !is_file(run) => (files, &run[files.len()..]),
        _ => (run, ""),
    };
    // A file's own name may have the character.
    let is_joined = files.contains('+') && !is_file(files) && files.split('+').any(is_file);
    let paths = match is_joined {
        true => files
            .split('+')
            .map(|one| if one.is_empty() { String::new() } else { path(one) })
            .collect::<Vec<_>>()
            .join("+"),
        false => path(files),
    };
    format!("{paths}{part}")
}

/// A path relative to a folder, with `/` between its parts; the whole path where they have nothing in common.
#[must_use]
pub fn relative(path: &str, folder: &Path) -> String {
    let whole = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (path, folder) = (plain(&whole(Path::new(path))), plain(&whole(folder)));
    let (parts, base): (Vec<_>, Vec<_>) = (path.components().collect(), folder.components().collect());
    let same = parts.iter().zip(&base).take_while(|(a, b)| a == b).count();
    let is_rooted = |part: &Component<'_>| matches!(part, Component::Prefix(_) | Component::RootDir);
    if same == 0 || parts[..same].iter().all(is_rooted) {
        return path.display().to_string();
    }
    let up = base[same..].iter().map(|_| "..".to_owned());
    let down = parts[same..].iter().map(|part| part.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

/// An absolute path without `.` and `..`, by its text.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => drop(plain.pop()),
            other => plain.push(other),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_relative_to_the_file() {
        for (path, folder, expected) in [
            ("/lab/runs/a.mcap", "/lab", "runs/a.mcap"),
            ("/lab/runs/a.mcap@2..8", "/lab/sessions", "../runs/a.mcap@2..8"),
            ("/lab/./x/../a.csv", "/lab", "a.csv"),
            ("/data/a.csv", "/lab/sessions", "/data/a.csv"),
        ] {
            assert_eq!(relative(path, Path::new(folder)), expected, "{path} in {folder}");
        }
    }

    /// A folder that is moved keeps recordings of several files.
    #[test]
    fn each_file_of_a_joined_recording_is_relative() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).display().to_string();
        ["a.csv", "b.csv", "c+d.csv"].iter().for_each(|name| std::fs::write(at(name), "").unwrap());
        let joined = format!("{}+{}@2..8", at("a.csv"), at("b.csv"));
        for (run, expected) in [
            (joined, "a.csv+b.csv@2..8"),
            (at("c+d.csv"), "c+d.csv"),
            (format!("{}@2..", at("a.csv")), "a.csv@2.."),
        ] {
            let own = relative_run(&run, folder.path());
            assert_eq!(own, expected);
            let named = Named { run: own, shown: true, shift_s: 0.0, notes: Vec::new() };
            let session = Session {
                schema: SCHEMA.into(),
                view: View::Time,
                recordings: vec![named],
                results: Vec::new(),
                range_s: None,
                cursors_s: None,
                fit_range_s: None,
                layout: Arrangement::default(),
                model: None,
            };
            assert_eq!(session.resolved(folder.path()).recordings[0].run, run);
        }
    }

    #[test]
    fn a_session_survives_its_file_and_says_what_is_missing() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.csv"), "t_s,a_V\n0,1\n1,2\n").unwrap();
        let notes = vec![Note { time_s: 0.5, text: "it squeaks".into() }];
        let named = |run: &str| Named { run: run.into(), shown: false, shift_s: 0.5, notes: notes.clone() };
        let session = Session {
            schema: SCHEMA.into(),
            view: View::Frequency,
            recordings: vec![named("a.csv@0..1"), named("gone.csv")],
            results: vec!["fit.json".into()],
            range_s: Some([0.0, 1.0]),
            cursors_s: None,
            fit_range_s: Some([0.25, 0.75]),
            layout: Arrangement::default(),
            model: None,
        };
        let read: Session = serde_json::from_str(&session.text()).unwrap();
        assert_eq!(read, session);
        let missing = read.resolved(folder.path()).missing();
        let expected = ["gone.csv", "fit.json"].map(|name| folder.path().join(name).display().to_string());
        assert_eq!(missing, expected);
    }
}
