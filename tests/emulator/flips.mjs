// Flips bits of a board's memory during a run at a constant voltage, one after the other just behind a tick, has the host say
// something before the next one, and says what came of them. Any board will do that counts its `writes` of the output, and knows its `volts`.

import { symbol } from './elf.mjs';

const RAM = 0x20000000;
/** A bit that matters acts at the next tick; after two its effect must have ended. */
const WITHIN_NS = 2_000_000;
const AGAIN_NS = 1_000_000;
const STEP_NS = 10_000;
const SAMPLING_EXCEPTION = 17;
const GPIO_OUT_SET = 0xd0000014;
const ENABLE = 1 << 22;

const around = (at, bytes) => Array.from({ length: (2 * bytes) / 4 + 1 }, (_, word) => at - bytes + 4 * word);

export class Flips {
  /**
   * Bits of the words of the sampling interrupt's data that hold one of `values`, or of `limits` with the word in front of each, or
   * `near.value` within `near.bytes` of `near.of`. `heartbeats`: two frames of the host for each bit. The output stays within `nearV` while
   * nothing is wrong.
   */
  constructor(board, { values, limits, near, bytes, heartbeats, nearV }) {
    this.board = board;
    this.start = symbol(board.image, /SAMPLER/) - RAM;
    this.bytes = bytes;
    this.volts = board.volts;
    this.nearV = nearV;
    this.heartbeats = heartbeats.map((frame) => Uint8Array.from(Buffer.from(frame, 'hex')));
    const words = new Set();
    const anchors = [];
    for (let at = this.start; at < this.start + bytes; at += 4) {
      const word = board.chip.rp2040.sramView.getUint32(at, true);
      if (values.includes(word) || limits.includes(word)) words.add(at);
      if (limits.includes(word)) words.add(at - 4);
      if (word === near.of) anchors.push(at);
    }
    for (const at of anchors.flatMap((anchor) => around(anchor, near.bytes))) {
      if (board.chip.rp2040.sramView.getUint32(at, true) === near.value) words.add(at);
    }
    this.bits = [...words].flatMap((at) => Array.from({ length: 32 }, (_, bit) => ({ at, bit })));
    this.outcome = { words: words.size, left: 0, off: 0, same: 0, harmful: [], peakV: 0 };
  }

  runs() {
    return this.board.enabled && Math.abs(this.board.volts - this.volts) < this.nearV;
  }

  /** Ends a sampling interrupt that is under way: it holds its data. */
  leave() {
    while (this.board.chip.core.IPSR === SAMPLING_EXCEPTION) this.board.runFor(STEP_NS);
  }

  /** Flips one bit, looks, and puts all the data back; returns whether there are more. */
  next() {
    const { board, outcome } = this;
    const { chip } = board;
    const { sram, sramView } = chip.rp2040;
    const { at, bit } = this.bits.pop();
    const tick = board.writes;
    while (board.writes === tick) board.runFor(STEP_NS);
    this.leave();
    if (!this.runs()) {
      const { off, same } = outcome;
      const said = sramView.getUint32(symbol(board.image, /STATE_AND_FAULT/) - RAM, true);
      const state = `enabled ${board.enabled}, ${board.volts} V for ${this.volts} V, state ${said & 255}, fault ${said >> 8}`;
      throw new Error(`the run is over before bit ${off + same} is flipped: ${state}`);
    }
    const kept = sram.slice(this.start, this.start + this.bytes);
    board.peakV = 0;
    sramView.setUint32(at, sramView.getUint32(at, true) ^ (1 << bit), true);
    board.usb.say(this.heartbeats.pop());
    const { writes } = board;
    board.runFor(WITHIN_NS);
    this.leave();
    const hasTicked = board.writes > writes;
    outcome.peakV = Math.max(outcome.peakV, board.peakV);
    if (!hasTicked) outcome.harmful.push({ offset: at - this.start, bit, late: true });
    else if (!board.enabled && board.volts === 0) outcome.off += 1;
    else if (this.runs() && board.chip === chip) outcome.same += 1;
    else outcome.harmful.push({ offset: at - this.start, bit, volts: board.volts, enabled: board.enabled });
    // The run goes on as if nothing had happened, with its enable line where the restored data say that it is.
    sram.set(kept, this.start);
    chip.rp2040.writeUint32(GPIO_OUT_SET, ENABLE);
    board.usb.say(this.heartbeats.pop());
    board.runFor(AGAIN_NS);
    outcome.left = this.bits.length;
    return outcome.left > 0 && board.chip === chip;
  }
}
