//! The check of the program in flash.

use socam_wire::Image;
use socam_wire::image::{self, Seal};

/// Address at which the flash is mapped, and its size.
const FLASH: usize = 0x1000_0000;
const FLASH_BYTES: usize = 2 << 20;

/// `socam-host flash` writes length and checksum of the image here.
#[used]
static SEAL: Seal = Seal::OPEN;

/// Compares the program with its checksum. This takes some 10 ms.
pub(crate) fn check() -> Image {
    // SAFETY: the flash is mapped there, and nothing writes to it.
    let flash = unsafe { core::slice::from_raw_parts(FLASH as *const u8, FLASH_BYTES) };
    image::check(flash, (&raw const SEAL).addr().wrapping_sub(FLASH))
}
