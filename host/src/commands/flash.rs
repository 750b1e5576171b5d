//! `flash`: the firmware onto the board.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, anyhow, bail};

use super::Outcome;
use crate::{output, uf2};

/// Flash the firmware onto the board
///
/// Hold the board's BOOTSEL button while plugging it in: it appears as a drive, accepts the image and starts it. The image gets a checksum
/// on its way, which the board compares at every start.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host flash firmware/target/thumbv6m-none-eabi/release/socam-firmware
  socam-host flash FIRMWARE --probe                                             with a debug probe attached
  socam-host flash FIRMWARE -o socam.uf2                                        to copy onto boot drives later")]
pub(crate) struct Args {
    /// Firmware image: ELF, as in firmware/target after `cargo build --release`, or UF2
    #[arg(value_name = "FIRMWARE")]
    image: PathBuf,
    /// Folder where the boot drive is mounted [default: searched in the usual places]
    #[arg(long, value_name = "FOLDER", conflicts_with = "probe")]
    drive: Option<PathBuf>,
    /// Flash through a debug probe with the program `probe-rs`
    #[arg(long)]
    probe: bool,
    /// Write the image with its checksum to a UF2 file; no board is needed
    #[arg(short, long, value_name = "FILE", conflicts_with_all = ["drive", "probe"])]
    output: Option<PathBuf>,
    /// Replace the UF2 file, if it exists
    #[arg(long)]
    force: bool,
}

/// The file that identifies a boot drive, and its text for this chip.
const MARK: &str = "INFO_UF2.TXT";
const CHIP: &str = "RPI-RP2";

/// Folders in which systems mount drives, directly or in a folder per user.
const MOUNTS: [&str; 4] = ["/media", "/run/media", "/Volumes", "/mnt"];

/// Longest image, bytes; the chip has 2 MiB of flash.
const LONGEST_IMAGE: u64 = 64 << 20;

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let image = socam_recording::read_regular(&args.image, LONGEST_IMAGE)
        .with_context(|| format!("`{}`", args.image.display()))?;
    let uf2 = uf2::of(&image).with_context(|| format!("`{}`", args.image.display()))?;
    if args.probe {
        return by_probe(&uf2);
    }
    if let Some(file) = args.output {
        return to_file(&uf2, &args.image, (&file, args.force));
    }
    let drive = match args.drive {
        Some(drive) if is_boot_drive(&drive) => drive,
        Some(drive) => bail!("`{}` is no boot drive: it has no {MARK} that names {CHIP}", drive.display()),
        None => find_drive().ok_or_else(|| {
            anyhow!("no board shows its boot drive: hold BOOTSEL while plugging it in, or name the drive's folder with --drive")
        })?,
    };
    let file = drive.join("socam.uf2");
    std::fs::write(&file, &uf2).with_context(|| format!("cannot write `{}`", file.display()))?;
    output::print(&format!("{} bytes to {}; the board restarts by itself\n", uf2.len(), file.display()))?;
    Ok(Outcome::Done)
}

fn to_file(uf2: &[u8], image: &Path, (file, replace): (&Path, bool)) -> anyhow::Result<Outcome> {
    output::check_target(file, image, replace)?;
    let mut written = output::create(file)?;
    written.write_all(uf2).with_context(|| format!("cannot write `{}`", file.display()))?;
    written.commit()?;
    output::print(&format!("{} bytes to {}\n", uf2.len(), file.display()))?;
    Ok(Outcome::Done)
}

fn by_probe(uf2: &[u8]) -> anyhow::Result<Outcome> {
    let mut file = tempfile::NamedTempFile::with_suffix(".uf2").context("cannot write a temporary file")?;
    file.write_all(uf2).context("cannot write a temporary file")?;
    let ended = Command::new("probe-rs")
        .args(["download", "--chip", "RP2040", "--verify", "--binary-format", "uf2"])
        .arg(file.path())
        .status();
    let ended =
        ended.context("cannot start probe-rs, which --probe needs (`cargo install probe-rs-tools`)")?;
    if !ended.success() {
        bail!("probe-rs did not put the firmware on the board");
    }
    Ok(Outcome::Done)
}

fn is_boot_drive(folder: &Path) -> bool {
    std::fs::read_to_string(folder.join(MARK)).is_ok_and(|text| text.contains(CHIP))
}

fn find_drive() -> Option<PathBuf> {
    let folders = |folder: &Path| {
        let entries = folder.read_dir().into_iter().flatten().map_while(Result::ok);
        entries.map(|entry| entry.path()).collect::<Vec<_>>()
    };
    let drives = MOUNTS.iter().flat_map(|mount| folders(Path::new(mount)));
    let drives: Vec<PathBuf> = drives.flat_map(|drive| folders(&drive).into_iter().chain([drive])).collect();
    drives.into_iter().find(|drive| is_boot_drive(drive))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uf2::tests::{elf, sealable};

    #[test]
    fn a_file_takes_what_a_boot_drive_takes_and_the_image_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let (image, file) = (folder.path().join("firmware"), folder.path().join("socam.uf2"));
        let built = elf(0x1000_0000, &sealable(1000));
        std::fs::write(&image, &built).unwrap();
        let to = |file: &Path| {
            run(Args {
                image: image.clone(),
                drive: None,
                probe: false,
                output: Some(file.into()),
                force: true,
            })
        };
        to(&file).unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), uf2::of(&built).unwrap());
        assert!(to(&image).unwrap_err().to_string().contains("written over itself"));
        assert_eq!(std::fs::read(&image).unwrap(), built);
    }
}
