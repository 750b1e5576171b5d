//! Firmware images: from ELF to UF2, the format of the board's boot drive.

use anyhow::{Context, bail};
use object::elf::PT_LOAD;
use object::read::elf::{ElfFile32, ProgramHeader};

/// Bytes of the image in each block.
const PAYLOAD: usize = 256;

/// A block with its head, room for 476 bytes and its tail.
const BLOCK: usize = 512;

/// "UF2\n", and two numbers that nobody writes by chance.
const MAGIC: [u32; 2] = [0x0a32_4655, 0x9e5d_5157];
const MAGIC_END: u32 = 0x0ab1_6f30;

/// The file says which chip it is for.
const HAS_FAMILY: u32 = 0x2000;
const RP2040: u32 = 0xe48b_ff56;

/// Where the chip's flash lies.
const FLASH: std::ops::Range<u64> = 0x1000_0000..0x1100_0000;

/// The image as the boot drive takes it, from an ELF file or as it is.
pub(crate) fn of(image: Vec<u8>) -> anyhow::Result<Vec<u8>> {
    if image.get(..4) == Some(&MAGIC[0].to_le_bytes()) {
        check(&image)?;
        return Ok(image);
    }
    from_elf(&image)
}

/// The boot drive ignores blocks that it does not like, without a word.
fn check(uf2: &[u8]) -> anyhow::Result<()> {
    let (blocks, rest) = uf2.as_chunks::<BLOCK>();
    let word =
        |block: &[u8; BLOCK], at: usize| u32::from_le_bytes(std::array::from_fn(|byte| block[at + byte]));
    for (number, block) in blocks.iter().enumerate() {
        let marks = [word(block, 0), word(block, 4), word(block, BLOCK - 4)];
        if marks != [MAGIC[0], MAGIC[1], MAGIC_END] || word(block, 20) != number as u32 {
            bail!("its block {number} is damaged: copy or build it again");
        }
        if word(block, 8) & HAS_FAMILY == 0 || word(block, 28) != RP2040 {
            bail!("it is made for another chip than the RP2040");
        }
    }
    let planned = blocks.first().map_or(0, |block| word(block, 24));
    if planned as usize != blocks.len() || !rest.is_empty() {
        bail!("it has {} whole blocks of {planned}: copy or build it again", blocks.len());
    }
    Ok(())
}

/// What of the image lies in flash, in whole pages.
fn from_elf(elf: &[u8]) -> anyhow::Result<Vec<u8>> {
    let pages = pages(elf)?;
    let mut uf2 = Vec::with_capacity(pages.len() * BLOCK);
    for (number, (address, page)) in pages.iter().enumerate() {
        let head = [HAS_FAMILY, *address, PAYLOAD as u32, number as u32, pages.len() as u32, RP2040];
        let end = uf2.len() + BLOCK;
        MAGIC.iter().chain(&head).for_each(|word| uf2.extend_from_slice(&word.to_le_bytes()));
        uf2.extend_from_slice(page);
        uf2.resize(end - 4, 0);
        uf2.extend_from_slice(&MAGIC_END.to_le_bytes());
    }
    Ok(uf2)
}

/// The pages of the flash that the image fills, in order; bytes that it does not name are erased ones.
fn pages(elf: &[u8]) -> anyhow::Result<Vec<(u32, [u8; PAYLOAD])>> {
    let file = ElfFile32::<object::Endianness>::parse(elf).context(
        "no whole ELF file of a 32-bit processor, as `cargo build --release` makes one in firmware/",
    )?;
    let endian = file.endian();
    let mut pages = std::collections::BTreeMap::<u32, [u8; PAYLOAD]>::new();
    for segment in file.elf_program_headers() {
        let address = u64::from(segment.p_paddr(endian));
        if segment.p_type(endian) != PT_LOAD || segment.p_filesz(endian) == 0 {
            continue;
        }
        let Ok(bytes) = segment.data(endian, elf) else {
            bail!("it is cut off at {} bytes: build or copy it again", elf.len())
        };
        if !FLASH.contains(&address) {
            bail!("a part of it belongs to address {address:#x}, which is not in the board's flash");
        }
        for (&byte, at) in bytes.iter().zip(segment.p_paddr(endian)..) {
            let start = at - at % PAYLOAD as u32;
            pages.entry(start).or_insert([0xff; PAYLOAD])[(at - start) as usize] = byte;
        }
    }
    match pages.first_key_value() {
        Some((&first, _)) if u64::from(first) == FLASH.start => Ok(pages.into_iter().collect()),
        _ => {
            bail!("nothing of it lies at the beginning of the board's flash, where its boot loader should be")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ELF file with one segment.
    fn elf(address: u32, bytes: &[u8]) -> Vec<u8> {
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

    #[test]
    fn blocks_carry_pages_of_the_flash() {
        let image: Vec<u8> = (0..300u32).map(|i| i as u8).collect();
        let uf2 = from_elf(&elf(0x1000_0000, &image)).unwrap();
        assert_eq!(uf2.len(), 2 * BLOCK);
        let word = |at: usize| u32::from_le_bytes(uf2[at..at + 4].try_into().unwrap());
        for block in 0..2 {
            let at = block * BLOCK;
            assert_eq!([word(at), word(at + 4), word(at + 508)], [0x0a32_4655, 0x9e5d_5157, 0x0ab1_6f30]);
            assert_eq!(word(at + 12), 0x1000_0000 + 256 * block as u32);
            assert_eq!([word(at + 16), word(at + 20), word(at + 24)], [256, block as u32, 2]);
        }
        assert_eq!(uf2[32..288], image[..256]);
        assert_eq!(uf2[544..588], image[256..]);
        assert!(uf2[588..800].iter().all(|byte| *byte == 0xff));
    }

    #[test]
    fn an_image_that_is_one_already_is_taken_whole_or_not_at_all() {
        let uf2 = from_elf(&elf(0x1000_0000, &[7; 1000])).unwrap();
        assert_eq!(of(uf2.clone()).unwrap(), uf2);
        let refused = |change: fn(&mut Vec<u8>)| {
            let mut uf2 = uf2.clone();
            change(&mut uf2);
            of(uf2).unwrap_err().to_string()
        };
        assert!(refused(|uf2| uf2.truncate(1536)).contains("3 whole blocks of 4"));
        assert!(refused(|uf2| uf2.truncate(2047)).contains("3 whole blocks of 4"));
        assert!(refused(|uf2| uf2[512 + 4] ^= 1).contains("block 1 is damaged"));
        assert!(refused(|uf2| uf2[28] ^= 1).contains("another chip"));
    }

    #[test]
    fn what_is_no_image_for_this_board_is_refused() {
        for (file, why) in [
            (b"#!/bin/sh".to_vec(), "no whole ELF file"),
            (elf(0x1000_0000, &[1; 300])[..200].to_vec(), "cut off at 200 bytes"),
            (elf(0x2000_0000, &[1]), "0x20000000"),
            (elf(0x1000_0100, &[1]), "beginning of the board's flash"),
        ] {
            assert!(from_elf(&file).unwrap_err().to_string().contains(why), "{why}");
        }
    }
}
