// Breaks the program in the ways in which programs break.

import { symbol } from './elf.mjs';

const SAMPLING_EXCEPTION = 17;
const HARD_FAULT = 3;
const STACK_END = 0x20000000;

/** `kind`: panic, hard-fault or overflow of the stack, in `context`: thread or interrupt. */
export function breakProgram(chip, image, kind, context) {
  const { core } = chip;
  chip.within(context === 'interrupt' ? SAMPLING_EXCEPTION : 0, () => {
    core.waiting = false;
    if (kind === 'panic') core.PC = symbol(image, /rust_begin_unwind/) & ~1;
    else if (kind === 'hard-fault') core.exceptionEntry(HARD_FAULT);
    // One word is left: whatever is called next, or interrupts, needs more.
    else core.registers[13] = STACK_END + 4;
  });
}
