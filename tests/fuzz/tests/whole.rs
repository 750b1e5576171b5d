//! Every parser, once, on its seeds, on the kept inputs of `corpus/` and on inputs that are hostile by their size or nesting: none panics,
//! takes more than 30 s or more than 2 GB, and each parser accepts some of its seeds.

use std::alloc::System;
use std::time::{Duration, Instant};

use cap::Cap;
use socam_fuzz::{Input, TARGETS, hostile, whole};

/// No allocation succeeds beyond this, and the process ends.
const MOST_BYTES: usize = 2_000_000_000;
const LONGEST: Duration = Duration::from_secs(30);

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, MOST_BYTES);

#[test]
fn every_parser_ends_at_seeds_and_at_hostile_inputs() {
    for target in &TARGETS {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("input").with_extension(target.extension);
        let parse = |bytes: &Vec<u8>| {
            std::fs::write(&path, bytes).unwrap();
            let begin = Instant::now();
            let accepted = (target.parse)(Input { bytes, path: &path });
            assert!(begin.elapsed() < LONGEST, "{}: {:?}", target.name, begin.elapsed());
            accepted
        };
        let accepted = whole(target, folder.path()).iter().filter(|bytes| parse(bytes)).count();
        assert!(accepted > 0, "{} accepts none of its seeds", target.name);
        for bytes in hostile(target) {
            parse(&bytes);
        }
    }
}
