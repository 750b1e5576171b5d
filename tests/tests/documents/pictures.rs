//! The pictures of the documents against those that the program draws now.

use std::path::Path;
use std::process::Command;

use socam_tests::program;

use super::{name, root};

/// Letters come out a shade different from one run to the next, and where another processor rounds otherwise.
const SHADES: u8 = 8;
const OTHERS: usize = 40;

/// Size, and bytes of the pixels.
fn read(file: &Path) -> ((u32, u32), Vec<u8>) {
    let opened = std::fs::File::open(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let mut reader = png::Decoder::new(std::io::BufReader::new(opened)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    bytes.truncate(info.buffer_size());
    ((info.width, info.height), bytes)
}

/// How many values of two pictures differ by more than [`SHADES`].
fn differences(a: &Path, b: &Path) -> usize {
    let ((size, a), (other, b)) = (read(a), read(b));
    if size != other || a.len() != b.len() {
        return a.len();
    }
    a.iter().zip(&b).filter(|(a, b)| a.abs_diff(**b) > SHADES).count()
}

#[test]
fn documents_show_what_the_program_draws() {
    let folder = tempfile::tempdir().unwrap();
    let drawn = Command::new(root().join("docs/draw-pictures"))
        .arg(folder.path())
        .env("SOCAM_HOST", program())
        .output()
        .expect("docs/draw-pictures starts");
    assert!(drawn.status.success(), "{}", String::from_utf8_lossy(&drawn.stderr));
    let mut old = Vec::new();
    for picture in folder.path().read_dir().unwrap() {
        let picture = picture.unwrap().path();
        let shown = root().join("docs").join(picture.file_name().unwrap());
        let differ = if shown.exists() { differences(&picture, &shown) } else { usize::MAX };
        if differ > OTHERS {
            old.push(name(&shown));
        }
    }
    assert!(
        old.is_empty(),
        "the program draws these otherwise; look, and draw them anew by docs/draw-pictures: {old:?}"
    );
}
