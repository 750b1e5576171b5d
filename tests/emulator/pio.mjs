// The programmable inputs and outputs in the chip's time; rp2040js runs them in JavaScript's event loop, in none.
//
// They are brought up to the present before the processor looks at them and before one of their pins changes. Rounds of an endless program in
// which nothing but a counter in X changes are skipped; one that waits for a pin does so until it changes.

const RXF = 0x20;

export class Pio {
  /** The first or second one (0, 1). `read(machine)`: the processor reads a machine's queue. */
  constructor(chip, number, read) {
    this.chip = chip;
    // The first one's programs count rounds in X, the second one's ends a loop by it.
    this.isEndless = number === 0;
    this.pio = chip.rp2040.pio[number];
    this.atNs = chip.nanos;
    this.due = new Float64Array(this.pio.machines.length);
    const { pio } = this;
    pio.run = () => {};
    const readUint32 = pio.readUint32.bind(pio);
    pio.readUint32 = (offset) => {
      this.catchUp();
      if (offset >= RXF && offset < RXF + 16) read((offset - RXF) / 4);
      return readUint32(offset);
    };
    const writeUint32 = pio.writeUint32.bind(pio);
    pio.writeUint32 = (offset, value) => {
      this.catchUp();
      writeUint32(offset, value);
    };
  }

  /** Runs all machines up to the present. */
  catchUp() {
    const cycles = (this.chip.nanos - this.atNs) / this.chip.cycleNs;
    this.atNs = this.chip.nanos;
    this.pio.machines.forEach((machine, number) => {
      if (!machine.enabled) return;
      this.due[number] += cycles / (machine.clockDivInt + machine.clockDivFrac / 256);
      this.due[number] -= run(machine, this.due[number], this.isEndless);
    });
  }
}

/** Runs a machine for at least so many of its cycles; returns how many it took. */
function run(machine, cycles, isEndless) {
  const began = machine.cycles;
  const until = began + cycles;
  let before = null;
  while (machine.cycles + 1 <= until) {
    const { pc } = machine;
    machine.step();
    machine.pio.checkChangedPins();
    // It waits for a pin, which changes only after it was brought up to the present.
    if (machine.waiting) machine.cycles = until;
    if (machine.pc > pc || !isEndless) continue;
    // The program went back: to where it was at the same instruction a round ago?
    const now = state(machine);
    if (before && before.same === now.same) {
      const round = now.cycles - before.cycles;
      const rounds = Math.max(0, Math.floor((until - machine.cycles) / round));
      machine.x = Number(BigInt.asUintN(32, BigInt(machine.x) - BigInt(rounds) * BigInt(before.x - now.x)));
      machine.cycles += rounds * round;
      before = null;
    } else {
      before = now;
    }
  }
  return machine.cycles - began;
}

function state(machine) {
  const { pc, y, outputShiftReg, inputShiftReg, rxFIFO, cycles, x } = machine;
  return { same: `${pc} ${y} ${outputShiftReg} ${inputShiftReg} ${rxFIFO.itemCount}`, cycles, x };
}
