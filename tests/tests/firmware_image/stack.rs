//! Stack use of functions, computed from their instructions.

use std::collections::{BTreeMap, BTreeSet};

use object::{Object, ObjectSection, SectionKind};

use super::{Code, Function};

/// Bytes that the processor stacks at an exception: eight words, and one to align them.
pub(super) const EXCEPTION_FRAME: u64 = 36;

/// Interrupts of different priorities, which can interrupt one another: embassy's clock, the link, sampling.
const INTERRUPTS: [&str; 3] = ["TIMER_IRQ_0", "USBCTRL_IRQ", "TIMER_IRQ_1"];

/// Calls through pointers: the executor polls a task, which calls a handler of the USB device, which wakes a task. Nothing that is woken
/// calls through a pointer again.
const POLLED: &str = "::poll";
const CALLS_BELOW_A_TASK: u64 = 2;

impl Code<'_> {
    /// Most bytes of stack that the whole program takes: thread, with all interrupts on top of one another and a fault on top of these.
    pub(super) fn deepest_of_all(&self, file: &object::File<'_>) -> [u64; 2] {
        let mut known = BTreeMap::new();
        let mut deepest = |functions: &[&Function]| {
            functions.iter().map(|function| self.deepest(function, &mut known)).max().unwrap_or(0)
        };
        let stored = self.stored(file);
        let is_program =
            |function: &&Function| !function.name.contains("IRQ") && !function.name.contains("Reset");
        let (tasks, others): (Vec<_>, Vec<_>) =
            stored.into_iter().filter(is_program).partition(|function| function.name.contains(POLLED));
        let called = deepest(&others);
        let thread = deepest(&[self.named("main")]) + deepest(&tasks) + CALLS_BELOW_A_TASK * called;
        let interrupts = INTERRUPTS.map(|name| EXCEPTION_FRAME + deepest(&[self.named(name)]) + called);
        let fault = EXCEPTION_FRAME + deepest(&[self.named("HardFault")]);
        [thread, interrupts.iter().sum::<u64>() + fault]
    }

    /// Functions whose address occurs anywhere in the image: all that a call through a pointer can reach.
    fn stored(&self, file: &object::File<'_>) -> Vec<&Function> {
        let kinds = [SectionKind::Text, SectionKind::ReadOnlyData, SectionKind::Data];
        let data = file.sections().filter(|section| kinds.contains(&section.kind()));
        let data: Vec<&[u8]> = data.filter_map(|section| section.data().ok()).collect();
        let words: BTreeSet<u64> = data
            .iter()
            .flat_map(|bytes| bytes.chunks_exact(4))
            .map(|word| u64::from(u32::from_le_bytes(std::array::from_fn(|i| word[i]))))
            .collect();
        self.functions.iter().filter(|function| words.contains(&(function.start | 1))).collect()
    }

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
