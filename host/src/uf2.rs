//! Firmware images: from ELF to UF2, the format of the board's boot drive, with their checksum.

use anyhow::{Context, bail};
use object::elf::PT_LOAD;
use object::read::elf::{ElfFile32, ProgramHeader};

/// Bytes of the image in each block.
const PAYLOAD: usize = 256;

/// A block with its head, room for bytes of the image and its tail.
const BLOCK: usize = 512;
const HEAD: usize = 32;
const ROOM: usize = 476;

/// A byte of erased flash.
const ERASED: u8 = 0xff;

/// The text `UF2\n`, and two numbers that are unlikely to occur by chance.
const MAGIC: [u32; 2] = [0x0a32_4655, 0x9e5d_5157];
const MAGIC_END: u32 = 0x0ab1_6f30;

/// Flag: the block names the family of its chip.
const HAS_FAMILY: u32 = 0x2000;
const RP2040: u32 = 0xe48b_ff56;

/// Addresses of the board's flash.
const FLASH: std::ops::Range<u32> = 0x1000_0000..0x1020_0000;

/// The image with its checksum in the boot drive's format, from an ELF file or a UF2 file.
pub(crate) fn of(file: &[u8]) -> anyhow::Result<Vec<u8>> {
    let is_uf2 = file.get(..4) == Some(&MAGIC[0].to_le_bytes());
    let parts = if is_uf2 { from_uf2(file)? } else { from_elf(file)? };
    let mut image = flash(&parts)?;
    socam_wire::image::seal(&mut image)?;
    Ok(blocks(&image))
}

/// A part of the image and its address.
type Part<'f> = (u32, &'f [u8]);

/// The parts in a file of the boot drive's format; the drive silently ignores invalid blocks.
fn from_uf2(uf2: &[u8]) -> anyhow::Result<Vec<Part<'_>>> {
    let (blocks, rest) = uf2.as_chunks::<BLOCK>();
    let word =
        |block: &[u8; BLOCK], at: usize| u32::from_le_bytes(std::array::from_fn(|byte| block[at + byte]));
    let mut parts = Vec::with_capacity(blocks.len());
    for (number, block) in blocks.iter().enumerate() {
        let marks = [word(block, 0), word(block, 4), word(block, BLOCK - 4)];
        let payload = block.get(HEAD..HEAD + word(block, 16) as usize).filter(|bytes| bytes.len() <= ROOM);
        let (Some(payload), true) =
            (payload, marks == [MAGIC[0], MAGIC[1], MAGIC_END] && word(block, 20) == number as u32)
        else {
            bail!("its block {number} is damaged: copy or build it again");
        };
        if word(block, 8) & HAS_FAMILY == 0 || word(block, 28) != RP2040 {
            bail!("it is made for another chip than the RP2040");
        }
        parts.push((word(block, 12), payload));
    }
    let planned = blocks.first().map_or(0, |block| word(block, 24));
    if planned as usize != blocks.len() || !rest.is_empty() {
        bail!("it has {} whole blocks of {planned}: copy or build it again", blocks.len());
    }
    Ok(parts)
}

/// The parts in an ELF file.
fn from_elf(elf: &[u8]) -> anyhow::Result<Vec<Part<'_>>> {
    let file = ElfFile32::<object::Endianness>::parse(elf).context(
        "no whole ELF file of a 32-bit processor, as `cargo build --release` makes one in firmware/",
    )?;
    let endian = file.endian();
    let mut parts = Vec::new();
    for segment in file.elf_program_headers() {
        if segment.p_type(endian) != PT_LOAD || segment.p_filesz(endian) == 0 {
            continue;
        }
        let Ok(bytes) = segment.data(endian, elf) else {
            bail!("it is cut off at {} bytes: build or copy it again", elf.len())
        };
        parts.push((segment.p_paddr(endian), bytes));
    }
    Ok(parts)
}

/// Content of the flash after all parts are written, from its beginning, in whole pages. Bytes that no part contains are erased.
fn flash(parts: &[Part<'_>]) -> anyhow::Result<Vec<u8>> {
    let mut flash = Vec::new();
    for (address, bytes) in parts {
        let end = u64::from(*address) + bytes.len() as u64;
        if !FLASH.contains(address) || end > u64::from(FLASH.end) {
            bail!("a part of it belongs to address {address:#x}, which is not in the board's flash");
        }
        let at = (address - FLASH.start) as usize;
        let end = at + bytes.len();
        if flash.len() < end {
            flash.resize(end.next_multiple_of(PAYLOAD), ERASED);
        }
        flash[at..end].copy_from_slice(bytes);
    }
    if parts.iter().all(|(address, _)| *address != FLASH.start) {
        bail!("nothing of it lies at the beginning of the board's flash, where its boot loader should be")
    }
    Ok(flash)
}

fn blocks(image: &[u8]) -> Vec<u8> {
    let (pages, _) = image.as_chunks::<PAYLOAD>();
    let mut uf2 = Vec::with_capacity(pages.len() * BLOCK);
    for (number, page) in (0u32..).zip(pages) {
        let address = FLASH.start + number * PAYLOAD as u32;
        let head = [HAS_FAMILY, address, PAYLOAD as u32, number, pages.len() as u32, RP2040];
        let end = uf2.len() + BLOCK;
        MAGIC.iter().chain(&head).for_each(|word| uf2.extend_from_slice(&word.to_le_bytes()));
        uf2.extend_from_slice(page);
        uf2.resize(end - 4, 0);
        uf2.extend_from_slice(&MAGIC_END.to_le_bytes());
    }
    uf2
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// An ELF file with one segment.
    pub(crate) fn elf(address: u32, bytes: &[u8]) -> Vec<u8> {
        let mut file = vec![0x7f, b'E', b'L', b'F', 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        for half in [2u16, 40] {
            file.extend(half.to_le_bytes());
        }
        for word in [1u32, 0, 52, 0, 0] {
            file.extend(word.to_le_bytes());
        }
        for half in [52u16, 32, 1, 40, 0, 0] {
            file.extend(half.to_le_bytes());
        }
        let length = bytes.len() as u32;
        for word in [1, 84, address, address, length, length, 5, 4] {
            file.extend(word.to_le_bytes());
        }
        file.extend(bytes);
        file
    }

    /// Bytes with a place for a checksum at their end.
    pub(crate) fn sealable(length: u32) -> Vec<u8> {
        let mut image: Vec<u8> = (0..length).map(|i| i as u8).collect();
        image.extend(b"socam image seal");
        image.extend([ERASED; 8]);
        image
    }

    #[test]
    fn blocks_carry_the_flash_and_its_checksum() {
        let image = sealable(276);
        let uf2 = of(&elf(0x1000_0000, &image)).unwrap();
        assert_eq!(uf2.len(), 2 * BLOCK);
        let word = |at: usize| u32::from_le_bytes(uf2[at..at + 4].try_into().unwrap());
        for block in 0..2 {
            let at = block * BLOCK;
            assert_eq!([word(at), word(at + 4), word(at + 508)], [0x0a32_4655, 0x9e5d_5157, 0x0ab1_6f30]);
            assert_eq!(word(at + 12), 0x1000_0000 + 256 * block as u32);
            assert_eq!([word(at + 16), word(at + 20), word(at + 24)], [256, block as u32, 2]);
        }
        let flash = [&uf2[32..288], &uf2[544..800]].concat();
        assert_eq!(flash[..292], image[..292]);
        assert!(flash[300..].iter().all(|byte| *byte == ERASED));
        assert_eq!(u32::from_le_bytes(flash[292..296].try_into().unwrap()), 512);
        assert_eq!(socam_wire::image::check(&flash, 276), socam_wire::Image::Whole);
    }

    #[test]
    fn an_image_that_is_one_already_is_taken_whole_or_not_at_all() {
        let uf2 = of(&elf(0x1000_0000, &sealable(1000))).unwrap();
        assert_eq!(of(&uf2).unwrap(), uf2);
        let refused = |change: fn(&mut Vec<u8>)| {
            let mut uf2 = uf2.clone();
            change(&mut uf2);
            of(&uf2).unwrap_err().to_string()
        };
        assert!(refused(|uf2| uf2.truncate(1536)).contains("3 whole blocks of 4"));
        assert!(refused(|uf2| uf2.truncate(2047)).contains("3 whole blocks of 4"));
        assert!(refused(|uf2| uf2[512 + 4] ^= 1).contains("block 1 is damaged"));
        assert!(refused(|uf2| uf2[512 + 17] = 4).contains("block 1 is damaged"));
        assert!(refused(|uf2| uf2[28] ^= 1).contains("another chip"));
    }

    #[test]
    fn what_is_no_image_for_this_board_is_refused() {
        for (file, why) in [
            (b"#!/bin/sh".to_vec(), "no whole ELF file"),
            (elf(0x1000_0000, &[1; 300])[..200].to_vec(), "cut off at 200 bytes"),
            (elf(0x2000_0000, &[1]), "0x20000000"),
            (elf(0x101f_ffff, &[1, 2]), "0x101fffff"),
            (elf(0x1000_0100, &[1]), "beginning of the board's flash"),
            (elf(0x1000_0000, &[1; 300]), "no place for its checksum"),
        ] {
            assert!(of(&file).unwrap_err().to_string().contains(why), "{why}");
        }
    }
}
