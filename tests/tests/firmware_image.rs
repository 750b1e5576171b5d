//! The firmware's image: what it takes of the board, and what its sampling interrupt can reach.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use object::read::elf::ProgramHeader;
use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};
use socam_tests::firmware::{self, limit};
use socam_tests::run;

mod stack;

/// Start address of the board's memory.
const MEMORY: u64 = 0x2000_0000;

/// Functions that must not be reachable: those that panic, and any allocator.
const FORBIDDEN: [&str; 6] =
    ["panic", "unwrap_failed", "expect_failed", "slice_index", "__rust_alloc", "alloc::"];

/// A function: its beginning, its end, its name.
struct Function {
    start: u64,
    end: u64,
    name: String,
}

/// The image's functions, and where literals lie between them.
struct Code<'d> {
    functions: Vec<Function>,
    /// Stretches of code: the address at which it begins and its bytes.
    text: Vec<(u64, &'d [u8])>,
    /// Addresses at which code (true) or data (false) begins.
    marks: BTreeMap<u64, bool>,
}

impl<'d> Code<'d> {
    fn of(file: &object::File<'d>) -> Self {
        let mut functions = Vec::new();
        let mut marks = BTreeMap::new();
        for symbol in file.symbols() {
            let name = symbol.name().unwrap_or_default();
            if name.starts_with("$t") || name.starts_with("$d") {
                marks.insert(symbol.address(), name.starts_with("$t"));
            } else if symbol.kind() == SymbolKind::Text && symbol.size() > 0 {
                let start = symbol.address() & !1;
                let name = rustc_demangle::demangle(name).to_string();
                functions.push(Function { start, end: start + symbol.size(), name });
            }
        }
        let is_code = |section: &object::Section<'d, '_>| section.kind() == SectionKind::Text;
        let text = file
            .sections()
            .filter(is_code)
            .filter_map(|section| Some((section.address(), section.data().ok()?)));
        let text = text.collect();
        Self { functions, text, marks }
    }

    fn named(&self, name: &str) -> &Function {
        self.functions
            .iter()
            .find(|function| function.name == name)
            .unwrap_or_else(|| panic!("there is no {name}"))
    }

    fn at(&self, address: u64) -> Option<&Function> {
        self.functions.iter().find(|function| (function.start..function.end).contains(&address))
    }

    fn half_word(&self, address: u64) -> Option<u32> {
        let (start, bytes) = self
            .text
            .iter()
            .find(|(start, bytes)| (*start..*start + bytes.len() as u64).contains(&address))?;
        let at = (address - start) as usize;
        Some(u32::from(u16::from_le_bytes([*bytes.get(at)?, *bytes.get(at + 1)?])))
    }

    fn is_code(&self, address: u64) -> bool {
        self.marks.range(..=address).next_back().is_none_or(|(_, is_code)| *is_code)
    }

    /// Targets of a function's calls and branches outside of it, and whether it jumps to an address from a register.
    fn leads_to(&self, function: &Function) -> (BTreeSet<u64>, bool) {
        let mut targets = BTreeSet::new();
        let mut jumps_anywhere = false;
        let mut address = function.start;
        while address < function.end {
            let Some(first) = self.half_word(address) else { break };
            if !self.is_code(address) {
                address += 2;
                continue;
            }
            let here = i64::try_from(address).unwrap() + 4;
            let mut reach = |offset: i64| {
                targets.insert(u64::try_from(here + offset).unwrap());
            };
            // Thumb, as ARMv6-M has it: BL is two half words, all branches are one.
            if first >> 11 == 0b11110 {
                let second = self.half_word(address + 2).unwrap_or(0);
                if second >> 14 == 0b11 {
                    reach(long_branch(first, second));
                }
                address += 2;
            } else if first >> 11 == 0b11100 {
                reach(signed(first & 0x7ff, 11) * 2);
            } else if first >> 12 == 0b1101 && (first >> 8) & 0xf < 0xe {
                reach(signed(first & 0xff, 8) * 2);
            }
            // BLX of a register; BX of one other than the link register.
            jumps_anywhere |= first & 0xff87 == 0x4780 || (first & 0xff87 == 0x4700 && first != 0x4770);
            address += 2;
        }
        targets.retain(|target| !(function.start..function.end).contains(target));
        (targets, jumps_anywhere)
    }

    /// All that can be reached from a function, with the way to it.
    fn reachable(&self, from: &str) -> BTreeMap<String, Vec<String>> {
        let mut found = BTreeMap::new();
        let mut open = vec![(self.named(from), vec![])];
        while let Some((function, way)) = open.pop() {
            if found.contains_key(&function.name) {
                continue;
            }
            let (targets, jumps_anywhere) = self.leads_to(function);
            assert!(!jumps_anywhere, "{} jumps where a register points: {way:?}", function.name);
            let mut further = way.clone();
            further.push(function.name.clone());
            found.insert(function.name.clone(), way);
            for target in targets {
                let next =
                    self.at(target).unwrap_or_else(|| panic!("{further:?} leads to {target:x}, no function"));
                open.push((next, further.clone()));
            }
        }
        found
    }
}

/// The offset of a BL.
fn long_branch(first: u32, second: u32) -> i64 {
    let sign = first >> 10 & 1;
    let upper = !((second >> 13) ^ sign) & 1;
    let lower = !((second >> 11) ^ sign) & 1;
    let bits = sign << 23 | upper << 22 | lower << 21 | (first & 0x3ff) << 11 | (second & 0x7ff);
    signed(bits, 24) * 2
}

fn signed(bits: u32, width: u32) -> i64 {
    let shift = 32 - width;
    i64::from(((bits << shift) as i32) >> shift)
}

#[test]
fn the_sampling_interrupt_cannot_panic_or_allocate() {
    firmware::image().into_iter().chain(firmware::gearmotor()).for_each(interrupt_is_bounded);
}

fn interrupt_is_bounded(image: &Path) {
    let data = std::fs::read(image).unwrap();
    let file = object::File::parse(&*data).unwrap();
    let code = Code::of(&file);
    let name = image.file_name().unwrap_or_default().display();
    let reachable = code.reachable("TIMER_IRQ_1");
    for (name, way) in &reachable {
        assert!(!FORBIDDEN.iter().any(|word| name.contains(word)), "{name} is reached by {way:?}");
    }
    println!(
        "measured: {name}: the sampling interrupt reaches {} functions, none of which can panic",
        reachable.len()
    );
    let stack_bytes = stack::EXCEPTION_FRAME + code.deepest(code.named("TIMER_IRQ_1"), &mut BTreeMap::new());
    println!("measured: {name}: the sampling interrupt takes at most {stack_bytes} bytes of stack");
    assert!((100..limit("interrupt_stack_bytes")).contains(&stack_bytes), "{stack_bytes}");
    // The search sees what there is to see: the program as a whole does panic, by the same calls.
    let panics = code.functions.iter().any(|function| {
        let (targets, _) = code.leads_to(function);
        targets.iter().filter_map(|target| code.at(*target)).any(|next| next.name.contains("panic"))
    });
    assert!(panics, "no call of a panic is found anywhere");
}

#[test]
fn the_stack_holds_all_that_the_program_can_put_there() {
    firmware::image().into_iter().chain(firmware::gearmotor()).for_each(stack_holds_all);
}

fn stack_holds_all(image: &Path) {
    let data = std::fs::read(image).unwrap();
    let file = object::File::parse(&*data).unwrap();
    let [thread, interrupts] = Code::of(&file).deepest_of_all(&file);
    let name = image.file_name().unwrap_or_default().display();
    println!(
        "measured: {name}: thread takes at most {thread} bytes of stack, all interrupts and a fault {interrupts}"
    );
    assert!(thread > 1000 && interrupts > limit("interrupt_stack_bytes") / 4, "{thread}, {interrupts}");
    assert!(thread + interrupts <= limit("stack_bytes"), "{thread} + {interrupts}");
}

#[test]
fn the_image_fits_the_board() {
    firmware::image().into_iter().chain(firmware::gearmotor()).for_each(image_fits);
}

fn image_fits(image: &Path) {
    let data = std::fs::read(image).unwrap();
    let file = object::File::parse(&*data).unwrap();
    let name = image.file_name().unwrap_or_default().display();
    let size = |kinds: &[SectionKind]| -> u64 {
        file.sections().filter(|section| kinds.contains(&section.kind())).map(|section| section.size()).sum()
    };
    let data = size(&[SectionKind::Data]);
    let flash = size(&[SectionKind::Text, SectionKind::ReadOnlyData, SectionKind::ReadOnlyString]) + data;
    let ram = size(&[SectionKind::UninitializedData]) + data;
    println!("measured: {name}: flash {flash} bytes, static memory {ram} bytes");
    assert!((20_000..limit("flash_bytes")).contains(&flash), "{flash}");
    let most = if image.ends_with("socam-gearmotor") { "gearmotor_static_bytes" } else { "static_bytes" };
    assert!((10_000..limit(most)).contains(&ram), "{ram}");
    let boot = file.section_by_name(".boot2").expect("the second-stage boot loader").data().unwrap();
    assert_eq!(
        u32::from_le_bytes(boot[252..].try_into().unwrap()),
        boot_checksum(&boot[..252]),
        "boot loader"
    );
}

#[test]
fn flash_puts_the_image_on_the_boot_drive_and_on_nothing_else() {
    let Some(image) = firmware::image() else { return };
    let folder = tempfile::tempdir().unwrap();
    let drive = folder.path();
    let flash = || run(["flash".as_ref(), image.as_os_str(), "--drive".as_ref(), drive.as_os_str()]);
    let refused = flash();
    assert_eq!(refused.code, Some(1), "{refused:?}");
    assert!(refused.stderr.contains("is no boot drive"), "{refused:?}");

    std::fs::write(drive.join("INFO_UF2.TXT"), "UF2 Bootloader v2.0\r\nBoard-ID: RPI-RP2\r\n").unwrap();
    let _ = flash().done();
    let uf2 = std::fs::read(drive.join("socam.uf2")).unwrap();
    let mut flashed = BTreeMap::new();
    for block in uf2.chunks_exact(512) {
        let address = u64::from(u32::from_le_bytes(block[12..16].try_into().unwrap()));
        flashed.extend((address..).zip(block[32..288].iter().copied()));
    }
    let data = std::fs::read(image).unwrap();
    let file = object::read::elf::ElfFile32::<object::Endianness>::parse(&*data).unwrap();
    // All bytes are as they were built, except those of length and checksum.
    let (mut compared, mut written) = (0, Vec::new());
    for segment in file.elf_program_headers() {
        let bytes = segment.data(file.endian(), &*data).unwrap();
        let address = u64::from(segment.p_paddr(file.endian()));
        for (address, byte) in (address..).zip(bytes) {
            match flashed.get(&address) {
                Some(flashed) if flashed == byte => compared += 1,
                Some(_) if *byte == 0xff => written.push(address),
                other => panic!("{address:#x}: {other:?} instead of {byte}"),
            }
        }
    }
    assert!(compared > 20_000, "{compared} bytes");
    assert!(!written.is_empty() && written[written.len() - 1] - written[0] < 8, "{written:x?}");
}

/// A stack that overflows must leave the memory, not reach statics, and forbid what lies there (`firmware/src/guard.rs`).
#[test]
fn the_stack_begins_where_the_memory_does() {
    let Some(image) = firmware::image() else { return };
    let data = std::fs::read(image).unwrap();
    let file = object::File::parse(&*data).unwrap();
    let vectors = file.section_by_name(".vector_table").expect("vectors").data().unwrap();
    let top = u64::from(u32::from_le_bytes(vectors[..4].try_into().unwrap()));
    assert_eq!(top, MEMORY + limit("stack_bytes"));
    let below = file.sections().filter(|section| section.size() > 0 && section.address() >= MEMORY);
    let below: Vec<_> =
        below.filter(|section| section.address() < top).map(|section| section.address()).collect();
    assert!(below.is_empty(), "{below:x?}");
}

/// The CRC-32 that the boot ROM expects behind its next stage: polynomial 04c11db7, from the highest bit, not inverted.
fn boot_checksum(bytes: &[u8]) -> u32 {
    bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte) << 24, |crc, _| {
            if crc >> 31 == 1 { crc << 1 ^ 0x04c1_1db7 } else { crc << 1 }
        })
    })
}
