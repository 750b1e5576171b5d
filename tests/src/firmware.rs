//! The firmware's image, built for its board.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

/// Target triple of the board's processor.
pub const TARGET: &str = "thumbv6m-none-eabi";

/// A limit of the image, by its name in `tests/tables/firmware.toml`.
///
/// # Panics
/// When the table has no such limit.
#[must_use]
pub fn limit(name: &str) -> u64 {
    let table: toml::Table = include_str!("../tables/firmware.toml").parse().expect("the table is TOML");
    let limit = table[name].as_integer().expect("a limit is a whole number");
    u64::try_from(limit).expect("a limit is positive")
}

/// The image as an ELF file, up to date; `None`, with the reason said, where this Rust cannot build it.
///
/// # Panics
/// When it does not build.
pub fn image() -> Option<&'static Path> {
    static IMAGE: OnceLock<Option<PathBuf>> = OnceLock::new();
    IMAGE.get_or_init(|| build(&[], "socam-firmware")).as_deref()
}

/// The gearmotor board's image, likewise.
///
/// # Panics
/// When it does not build.
pub fn gearmotor() -> Option<&'static Path> {
    static IMAGE: OnceLock<Option<PathBuf>> = OnceLock::new();
    IMAGE.get_or_init(|| build(&[], "socam-gearmotor")).as_deref()
}

/// The program that runs the core's exercises (`firmware/examples/core_on_board`), likewise.
///
/// # Panics
/// When it does not build.
pub fn core_on_board() -> Option<PathBuf> {
    build(&["--example", "core_on_board"], "examples/core_on_board")
}

fn build(what: &[&str], file: &str) -> Option<PathBuf> {
    if !has_target(TARGET) {
        crate::skip(&format!("Rust here has no target {TARGET}, which the firmware is built for"));
        return None;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware");
    let target = kept("firmware");
    let built = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--locked", "--release", "--target-dir"])
        .arg(&target)
        .args(what)
        .current_dir(&folder)
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_TARGET_DIR")
        .stdin(Stdio::null())
        .output()
        .expect("cargo starts");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    Some(target.join(TARGET).join("release").join(file))
}

/// Whether the compiler here can build for a target.
#[must_use]
pub fn has_target(target: &str) -> bool {
    let output = Command::new("rustc").args(["--print", "target-libdir", "--target", target]).output();
    output.is_ok_and(|output| Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir())
}

/// A folder beside the build, so that `cargo clean` takes it too.
///
/// # Panics
/// When this program does not lie in a target folder.
pub fn kept(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("this test's path");
    test.ancestors().nth(3).expect("target/PROFILE/deps/TEST").join(name)
}
