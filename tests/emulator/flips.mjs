// Flips bits of the board's memory during a run at a constant voltage, one after the other, and says what came of them.

import { symbol } from './elf.mjs';

const RAM = 0x20000000;
/** A bit that matters acts at the next tick; after two its effect must have ended. */
const WITHIN_NS = 2_000_000;
const AGAIN_NS = 2_000_000;
const NEAR_V = 1e-3;

export class Flips {
  /** Bits of the words of the sampling interrupt's data that hold one of `values`, or of `limits` with the word in front of each. */
  constructor(board, { values, limits, bytes }) {
    this.board = board;
    this.start = symbol(board.image, /SAMPLER/) - RAM;
    this.bytes = bytes;
    this.volts = board.output.volts;
    const words = new Set();
    for (let at = this.start; at < this.start + bytes; at += 4) {
      const word = board.chip.rp2040.sramView.getUint32(at, true);
      if (values.includes(word) || limits.includes(word)) words.add(at);
      if (limits.includes(word)) words.add(at - 4);
    }
    this.bits = [...words].flatMap((at) => Array.from({ length: 32 }, (_, bit) => ({ at, bit })));
    this.outcome = { words: words.size, left: 0, off: 0, same: 0, harmful: [], peakV: 0 };
  }

  /** Flips one bit, looks, and puts all the data back; returns whether there are more. */
  next() {
    const { board, outcome } = this;
    const { chip, output } = board;
    const { sram, sramView } = chip.rp2040;
    const { at, bit } = this.bits.pop();
    const kept = sram.slice(this.start, this.start + this.bytes);
    board.peakV = 0;
    sramView.setUint32(at, sramView.getUint32(at, true) ^ (1 << bit), true);
    board.runFor(WITHIN_NS);
    outcome.peakV = Math.max(outcome.peakV, board.peakV);
    if (!board.enabled && output.volts === 0) outcome.off += 1;
    else if (board.enabled && Math.abs(output.volts - this.volts) < NEAR_V && board.chip === chip) outcome.same += 1;
    else outcome.harmful.push({ offset: at - this.start, bit, volts: output.volts, enabled: board.enabled });
    sram.set(kept, this.start);
    board.runFor(AGAIN_NS);
    outcome.left = this.bits.length;
    return outcome.left > 0 && board.chip === chip;
  }
}
