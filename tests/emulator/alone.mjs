// `node alone.mjs PROGRAM.elf`: the processor alone runs a program to its first breakpoint; prints what it says on its first serial line.

import { readFileSync } from 'node:fs';
import { Cause, Chip } from './chip.mjs';

const PATIENCE_NS = 60e9;

const chip = new Chip(readFileSync(process.argv[2]), Cause.POWER);
let said = '';
let ended = false;
chip.rp2040.uart[0].onByte = (byte) => {
  said += String.fromCharCode(byte);
};
chip.rp2040.onBreak = () => {
  ended = true;
};
while (!ended) {
  if (chip.nanos > PATIENCE_NS) throw new Error(`the program does not end; it said: ${said}`);
  chip.runUntil(chip.nanos + 1_000_000);
}
process.stdout.write(said);
