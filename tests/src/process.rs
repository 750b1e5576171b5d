//! `socam-host` as a process.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

/// The program of this workspace: `SOCAM_HOST`, which `tests/run` has built together with the tests, or one that cargo builds now with the
/// profile of this test.
///
/// # Panics
/// When it does not build.
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| std::env::var_os("SOCAM_HOST").map_or_else(build, PathBuf::from))
}

fn build() -> PathBuf {
    let test = std::env::current_exe().expect("this test's path");
    let folder = test.ancestors().nth(2).expect("target/PROFILE/deps/TEST");
    let profile = match folder.file_name().and_then(OsStr::to_str) {
        Some("debug") | None => "dev",
        Some(profile) => profile,
    };
    // Cargo chooses the features of shared libraries by what is built together.
    let together: &[&str] = if cfg!(feature = "full") {
        &["--workspace"]
    } else {
        &["--package", "socam-host", "--no-default-features"]
    };
    let built = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--bin", "socam-host", "--profile", profile])
        .args(together)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stdin(Stdio::null())
        .output()
        .expect("cargo starts");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    folder.join(format!("socam-host{}", std::env::consts::EXE_SUFFIX))
}

/// The program, without standard input and colours.
#[must_use]
pub fn socam_host() -> Command {
    let mut command = Command::new(program());
    command.stdin(Stdio::null()).env("NO_COLOR", "1").env("RUST_BACKTRACE", "0");
    command
}

/// Exit status and output of the program.
#[derive(Debug)]
pub struct Ran {
    /// Exit code; `None` when a signal ended it.
    pub code: Option<i32>,
    /// Results.
    pub stdout: String,
    /// Talk.
    pub stderr: String,
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("text");
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }
}

/// Runs the program to its end.
///
/// # Panics
/// When it does not start.
pub fn run<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> Ran {
    socam_host().args(arguments).output().expect("socam-host starts").into()
}

/// Records a device into a log, with more arguments.
#[must_use]
pub fn record(device: &str, log: &str, more: &[&str]) -> Ran {
    run(["record", "-o", log, "--device", device, "--json"].iter().chain(more))
}

impl Ran {
    /// The JSON document that it printed, whatever its exit code.
    ///
    /// # Panics
    /// When there is anything else.
    #[must_use]
    pub fn document(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|_| panic!("{self:?}"))
    }

    /// Standard output of a program that succeeded.
    ///
    /// # Panics
    /// When it did not.
    #[must_use]
    pub fn done(self) -> String {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self.stdout
    }

    /// The JSON document that it printed.
    ///
    /// # Panics
    /// When there is anything else, or more than one.
    #[must_use]
    pub fn json(self) -> serde_json::Value {
        let text = self.done();
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("not one JSON document ({error}): {text}"))
    }

    /// The JSON document of a program whose search was ended before its own end: by its `budget`, or `interrupted`.
    ///
    /// # Panics
    /// When it ended otherwise, or printed anything else.
    #[must_use]
    pub fn unfinished_json(self, end: &str) -> serde_json::Value {
        let code = if end == "interrupted" { 130 } else { 0 };
        assert_eq!(self.code, Some(code), "{}", self.stderr);
        let document = Self { code: Some(0), ..self }.json();
        assert_eq!((&document["end"], &document["finished"]), (&end.into(), &false.into()));
        document
    }

    /// The one sentence in which it refused: on stderr, in one line, and nothing on stdout.
    ///
    /// # Panics
    /// When it did not refuse, crashed, or said anything else.
    #[must_use]
    pub fn refusal(&self, code: i32) -> &str {
        assert_eq!(self.code, Some(code), "{self:?}");
        assert_eq!(self.stdout, "", "{self:?}");
        let sentence = self.stderr.strip_prefix("error: ").and_then(|rest| rest.strip_suffix('\n'));
        let sentence = sentence.unwrap_or_else(|| panic!("{self:?}"));
        assert!(!sentence.contains('\n') && !sentence.contains(". "), "more than one sentence: {sentence}");
        sentence
    }
}
