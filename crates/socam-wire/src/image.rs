//! The check of a firmware's image: a checksum that is put into it when it is flashed, and compared when it starts.

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::encoder::CHECKSUM;

/// Byte pattern in front of length and checksum, by which they are found in an image.
const MARK: [u8; 16] = *b"socam image seal";

/// Bytes of length and checksum.
const PLACE: usize = 8;

/// Length and checksum before they are known: erased flash.
const OPEN: [u8; PLACE] = [0xff; PLACE];

/// The part of an image that tells its length and checksum; an image has one.
#[derive(Debug)]
#[repr(C, align(4))]
pub struct Seal([u8; MARK.len()], [u8; PLACE]);

impl Seal {
    /// The seal of an image that has not been flashed yet.
    pub const OPEN: Self = Self(MARK, OPEN);
}

/// Result of the board's comparison of its image with the seal, when it started.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Image {
    /// The image is the one that was flashed.
    Whole,
    /// The image carries no checksum: it was put on the board by a debugger, not by `socam-host flash`.
    Unsealed,
    /// The image is not the one that was flashed.
    Damaged,
}

impl fmt::Display for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Whole => "whole",
            Self::Unsealed => "not checked: it carries no checksum",
            Self::Damaged => "damaged",
        })
    }
}

/// An image without one open seal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotSealable;

impl fmt::Display for NotSealable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("it has no place for its checksum, or more than one: it is no firmware of this version")
    }
}

impl core::error::Error for NotSealable {}

/// Writes length and checksum into an image, which begins at the beginning of the flash. A sealed image is sealed anew.
pub fn seal(image: &mut [u8]) -> Result<(), NotSealable> {
    let mut places = image.windows(MARK.len()).enumerate().filter(|(_, window)| **window == MARK);
    let (Some((at, _)), None) = (places.next(), places.next()) else { return Err(NotSealable) };
    let at = at.saturating_add(MARK.len());
    let length = u32::try_from(image.len()).map_err(|_| NotSealable)?;
    let checksum = checksum(image, at).ok_or(NotSealable)?;
    let place = image.get_mut(at..at.saturating_add(PLACE)).ok_or(NotSealable)?;
    let bytes = length.to_le_bytes().into_iter().chain(checksum.to_le_bytes());
    place.iter_mut().zip(bytes).for_each(|(place, byte)| *place = byte);
    Ok(())
}

/// Compares an image with its seal. `flash` is all of the flash, `seal_at` the place of the [`Seal`] in it.
pub fn check(flash: &[u8], seal_at: usize) -> Image {
    let at = seal_at.saturating_add(MARK.len());
    let place = flash.get(at..at.saturating_add(PLACE));
    let Some(&[l0, l1, l2, l3, c0, c1, c2, c3]) = place else { return Image::Damaged };
    if [l0, l1, l2, l3, c0, c1, c2, c3] == OPEN {
        return Image::Unsealed;
    }
    let length = usize::try_from(u32::from_le_bytes([l0, l1, l2, l3])).unwrap_or(usize::MAX);
    let found = flash.get(..length).and_then(|image| checksum(image, at));
    if found == Some(u32::from_le_bytes([c0, c1, c2, c3])) { Image::Whole } else { Image::Damaged }
}

/// The checksum of an image as if length and checksum, at `at`, were not written yet.
fn checksum(image: &[u8], at: usize) -> Option<u32> {
    let mut digest = CHECKSUM.digest();
    digest.update(image.get(..at)?);
    digest.update(&OPEN);
    digest.update(image.get(at.checked_add(PLACE)?..)?);
    Some(digest.finalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    const AT: usize = 300;

    fn image() -> Vec<u8> {
        let mut image: Vec<u8> = (0..1024u32).map(|i| i as u8).collect();
        image[AT..AT + 16].copy_from_slice(&MARK);
        image[AT + 16..AT + 24].copy_from_slice(&OPEN);
        image
    }

    #[test]
    fn every_flipped_bit_of_a_sealed_image_is_found() {
        let mut flash = image();
        assert_eq!(check(&flash, AT), Image::Unsealed);
        seal(&mut flash).unwrap();
        let sealed = flash.clone();
        // The flash is longer than the image.
        flash.extend([0xff; 512]);
        assert_eq!(check(&flash, AT), Image::Whole);
        for bit in 0..8 * sealed.len() {
            flash[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(check(&flash, AT), Image::Damaged, "bit {bit}");
            flash[bit / 8] ^= 1 << (bit % 8);
        }
        seal(&mut flash[..sealed.len()]).unwrap();
        assert_eq!(flash[..sealed.len()], sealed, "sealing again changes nothing");
    }

    #[test]
    fn an_image_without_one_seal_is_refused() {
        assert_eq!(seal(&mut vec![0; 1024]), Err(NotSealable));
        assert_eq!(seal(&mut [image(), image()].concat()), Err(NotSealable));
        assert_eq!(seal(&mut image()[..AT + 20]), Err(NotSealable));
    }
}
