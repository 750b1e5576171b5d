//! A call: from its arguments to the words of a command, and what the command answers.

use std::{
    path::{Component, Path, PathBuf},
    process::Stdio,
};

use serde_json::{Map, Value};
use tokio::{
    io::{AsyncRead, AsyncReadExt},
    process::Command,
};

use crate::{
    error::{McpError, Result},
    schema,
    tools::{Argument, Takes, Tool},
};

/// Largest answer, bytes. A document of a diagnosis has about 50,000.
const MOST_BYTES: u64 = 4_000_000;

/// What a command answered.
pub(crate) struct Answer {
    /// Exit code; `None` where a signal ended it.
    pub(crate) code: Option<i32>,
    /// What it printed on stdout.
    pub(crate) text: String,
    /// What it printed on stderr.
    pub(crate) messages: String,
}

/// The words of the command that a tool runs with these arguments. A written file's path is taken below `folder`.
///
/// # Errors
/// [`McpError::Argument`] for an argument that is missing or of another type, [`McpError::Outside`], and [`McpError::Option`] for an
/// option that the task refuses.
pub(crate) fn words(
    tool: &Tool,
    mut given: Map<String, Value>,
    folder: Option<&Path>,
) -> Result<Vec<String>> {
    if let Some(argument) =
        tool.arguments.iter().find(|one| folder.is_none() && one.is_written() && given.contains_key(one.name))
    {
        let expected = "a server that may write: one started with `--write DIR`".into();
        return Err(McpError::Argument { name: argument.name.into(), expected });
    }
    let mut words: Vec<String> = tool.command.iter().map(|word| (*word).to_owned()).collect();
    let mut files = Vec::new();
    for argument in schema::arguments(tool, folder) {
        match given.remove(argument.name).filter(|value| !value.is_null()) {
            Some(value) => {
                let own = words_of(argument, &value, folder)?;
                if argument.is_file() { files.extend(own) } else { words.extend(own) }
            }
            None if argument.is_required => return Err(argument.expects("a value")),
            None => {}
        }
    }
    match tool.task {
        Some(task) => words.extend(socam_job::words(task, given)?),
        None => {
            if let Some(name) = given.keys().next() {
                let known: Vec<&str> = schema::arguments(tool, folder).map(|one| one.name).collect();
                let expected = format!("no such argument; `{}` takes {}", tool.name, known.join(", "));
                return Err(McpError::Argument { name: name.clone(), expected });
            }
        }
    }
    // What follows is no option, whatever a file is called.
    if !files.is_empty() {
        words.push("--".into());
        words.extend(files);
    }
    Ok(words)
}

/// The words of one argument.
fn words_of(argument: &Argument, value: &Value, folder: Option<&Path>) -> Result<Vec<String>> {
    let text = || value.as_str().map(str::to_owned).ok_or_else(|| argument.expects("a text"));
    let texts = || {
        let all = value.as_array().filter(|all| !all.is_empty());
        let all = all.and_then(|all| all.iter().map(|one| one.as_str().map(str::to_owned)).collect());
        all.ok_or_else(|| argument.expects("a list of texts"))
    };
    match argument.takes {
        Takes::Files => texts(),
        Takes::File => Ok(vec![text()?]),
        Takes::Flagged(flag) => {
            let files: Vec<String> = texts()?;
            Ok(files.into_iter().map(|file| format!("{flag}={file}")).collect())
        }
        Takes::One(flag) => Ok(vec![format!("{flag}={}", text()?)]),
        Takes::Word(flag, known) => {
            let word = text()?;
            if !known.contains(&word.as_str()) {
                return Err(argument.expects(&format!("one of {}", known.join(", "))));
            }
            Ok(vec![if flag.is_empty() { word } else { format!("{flag}={word}") }])
        }
        Takes::Written(flag) => {
            let path = below(folder.unwrap_or(Path::new("")), &text()?)?;
            Ok(vec![format!("{flag}={}", path.display())])
        }
    }
}

impl Argument {
    /// The error for a value that is not what it takes.
    fn expects(&self, expected: &str) -> McpError {
        McpError::Argument { name: self.name.into(), expected: format!("{expected}: {}", self.about) }
    }
}

/// A path below a folder.
fn below(folder: &Path, path: &str) -> Result<PathBuf> {
    let is_below =
        Path::new(path).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if path.is_empty() || !is_below {
        return Err(McpError::Outside { path: path.into() });
    }
    Ok(folder.join(path))
}

/// Runs the program with these words and waits for its answer. The process is killed where this is dropped.
///
/// # Errors
/// [`McpError::System`] where it cannot be started, its answer cannot be read or is too long.
pub(crate) async fn run(program: &Path, words: &[String]) -> Result<Answer> {
    let cannot = || McpError::system(format!("cannot run `{}`", program.display()));
    let mut child = Command::new(program)
        .args(words)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .kill_on_drop(true)
        .spawn()
        .map_err(cannot())?;
    let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
    let (text, messages) = tokio::try_join!(text_of(stdout), text_of(stderr)).map_err(cannot())?;
    let status = child.wait().await.map_err(cannot())?;
    Ok(Answer { code: status.code(), text, messages })
}

/// All of a stream as text, up to [`MOST_BYTES`].
async fn text_of(stream: Option<impl AsyncRead + Unpin>) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    if let Some(stream) = stream {
        stream.take(MOST_BYTES + 1).read_to_end(&mut bytes).await?;
    }
    if bytes.len() as u64 > MOST_BYTES {
        let problem = format!(
            "its answer is longer than {MOST_BYTES} bytes: ask for less, such as a part of a recording (RUN@FROM..TO)"
        );
        return Err(std::io::Error::other(problem));
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::tools::TOOLS;

    fn words_of(tool: &str, given: Value, folder: Option<&str>) -> Result<String> {
        let tool = TOOLS.iter().find(|one| one.name == tool).unwrap();
        let Value::Object(given) = given else { panic!("arguments are an object") };
        words(tool, given, folder.map(Path::new)).map(|words| words.join(" "))
    }

    #[test]
    fn arguments_become_the_words_of_a_command() {
        let given = json!({ "recordings": ["-a.mcap", "b.mcap"], "holdout": ["c.mcap"], "model": "m.toml", "most": 2,
            "why": ["backlash@mesh"] });
        assert_eq!(
            words_of("diagnose", given, None).unwrap(),
            "diagnose --json --holdout=c.mcap --model m.toml --most 2 --why backlash@mesh -- -a.mcap b.mcap"
        );
        let given = json!({ "recordings": ["a.mcap"], "report": "one/page" });
        assert_eq!(
            words_of("report", given, Some("/out")).unwrap(),
            "diagnose --report=/out/one/page -- a.mcap"
        );
        assert_eq!(words_of("template", json!({ "kind": "model" }), None).unwrap(), "template model");
    }

    #[test]
    fn wrong_arguments_are_refused_in_one_sentence() {
        let refused =
            |tool: &str, given: Value, folder| words_of(tool, given, folder).unwrap_err().to_string();
        let run = json!(["a.mcap"]);
        assert!(refused("info", json!({}), None).starts_with("`recordings`: expected a value"));
        assert!(refused("info", json!({ "recordings": "a.mcap" }), None).contains("a list of texts"));
        assert!(refused("info", json!({ "recordings": run, "depth": 1 }), None).contains("no such argument"));
        assert!(refused("diagnose", json!({ "recordings": run, "most": 9 }), None).contains("--most"));
        assert!(
            refused("diagnose", json!({ "recordings": run, "mots": 2 }), None)
                .contains("there is no option `mots`")
        );
        for outside in ["/etc/page", "../page", "a/../../page", ""] {
            let given = json!({ "recordings": run, "report": outside });
            assert!(
                refused("diagnose", given, Some("/out")).contains("folder that may be written"),
                "{outside}"
            );
        }
        // A server that may not write has no argument that writes.
        let given = json!({ "recordings": run, "write_model": "m.toml" });
        assert!(refused("diagnose", given, None).contains("started with `--write DIR`"));
    }
}
