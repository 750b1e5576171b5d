//! How much stack functions take, by their instructions.

use std::collections::BTreeMap;

use super::{Code, Function};

/// What the processor stacks at an exception: eight words, and one to align them.
pub(super) const EXCEPTION_FRAME: u64 = 36;

impl Code<'_> {
    /// Most bytes that a function and what it calls take. No function here calls itself, directly or through others.
    pub(super) fn deepest(&self, function: &Function, known: &mut BTreeMap<u64, u64>) -> u64 {
        if let Some(&depth) = known.get(&function.start) {
            assert_ne!(depth, u64::MAX, "{} calls itself", function.name);
            return depth;
        }
        known.insert(function.start, u64::MAX);
        let (targets, _) = self.leads_to(function);
        let callees = targets.iter().filter_map(|target| self.at(*target));
        let below = callees.map(|callee| self.deepest(callee, known)).max().unwrap_or(0);
        let depth = self.frame(function) + below;
        known.insert(function.start, depth);
        depth
    }

    /// Bytes that a function's own instructions take: all of them added up, whichever are run.
    fn frame(&self, function: &Function) -> u64 {
        let mut bytes = 0;
        let mut loaded = [None; 8];
        for address in (function.start..function.end).step_by(2).filter(|address| self.is_code(*address)) {
            let Some(word) = self.half_word(address) else { continue };
            let register = usize::try_from(word >> 8 & 7).unwrap();
            match word {
                // PUSH, of eight registers and the link register.
                _ if word >> 9 == 0b101_1010 => bytes += 4 * u64::from((word & 0x1ff).count_ones()),
                // SUB SP, #imm.
                _ if word >> 7 == 0b1_0110_0001 => bytes += 4 * u64::from(word & 0x7f),
                // LDR Rt, [PC, #imm].
                _ if word >> 11 == 0b01001 => {
                    let literal = ((address + 4) & !3) + 4 * u64::from(word & 0xff);
                    let halves = self.half_word(literal).zip(self.half_word(literal + 2));
                    loaded[register] = halves.map(|(low, high)| (high << 16 | low) as i32);
                }
                // ADD SP, Rm: frames that are too large for an immediate.
                _ if word & 0xff87 == 0x4485 => {
                    let register = usize::try_from(word >> 3 & 0xf).unwrap();
                    let by = loaded.get(register).copied().flatten();
                    let by = by.unwrap_or_else(|| panic!("{}: SP moves by an unknown amount", function.name));
                    bytes += u64::from(by.min(0).unsigned_abs());
                }
                // MOV SP, Rm: from a frame pointer, which only gives back.
                _ => {}
            }
        }
        bytes
    }
}
