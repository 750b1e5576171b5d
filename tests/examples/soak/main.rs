//! Records simulations of all sources at once, each by a `socam-host record` of its own, for as long as wanted; meanwhile it cuts links, kills devices
//! and recorders (`kill -9`), and at the end compares what was sent with what was recorded. `docs/devices.md` has what an hour gave.
//!
//! ```sh
//! cargo build --release --workspace --bins --examples && SOCAM_HOST=target/release/socam-host target/release/examples/soak --minutes 60
//! ```
//!
//! Each row holds its number `k`, in a channel or as a position, so that a recording says which rows it lacks. A device is a process of this
//! program, `soak device KIND ...`, so that it can be killed; it keeps what it has sent in a file, which outlives it.

#[cfg(unix)]
mod asked;
#[cfg(unix)]
mod device;
#[cfg(unix)]
mod kind;
#[cfg(unix)]
mod link;
#[cfg(unix)]
mod run;
#[cfg(unix)]
mod source;
#[cfg(unix)]
mod talking;
#[cfg(unix)]
mod tally;

#[cfg(unix)]
fn main() -> std::process::ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words[..] {
        ["device", kind, place, state, first] => device::serve(kind, place, state, first),
        ["--minutes", minutes] => run::run(minutes, None, &[]),
        ["--minutes", minutes, "--folder", folder] => run::run(minutes, Some(folder), &[]),
        ["--minutes", minutes, "--folder", folder, "--only", ref kinds @ ..] => {
            run::run(minutes, Some(folder), kinds)
        }
        _ => Err("usage: soak --minutes 60 [--folder FOLDER [--only KIND...]]".into()),
    };
    match done {
        Ok(true) => std::process::ExitCode::SUCCESS,
        Ok(false) => std::process::ExitCode::FAILURE,
        Err(problem) => {
            eprintln!("error: {problem}");
            std::process::ExitCode::FAILURE
        }
    }
}

#[cfg(not(unix))]
fn main() {
    eprintln!("error: the soak simulates serial lines by pseudo-terminals, which this system does not have");
}
