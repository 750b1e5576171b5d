// An HX711 on a load cell, at its two pins: DOUT falls where a conversion is ready, each pulse of PD_SCK shifts a bit out, the 25th ends
// it, and a pulse of more than 60 us switches the chip off. 80 conversions per second.
//
// A conversion is the mean over the time in which the chip settles, four conversions, with the noise of a gain of 128 at 3.3 V.

const PIN = { data: 12, clock: 13 };
const CONVERSION_NS = 12_500_000;
const SETTLING = 4;
const NOISE_CODES = 58;
const BITS = 24;
const OFF_AFTER_US = 60;
// The program's cycles in a microsecond of the chip.
const CYCLES_PER_US = 125;

export class Hx711 {
  /** `before`: the same one before the chip's reset, of which it knows nothing. */
  constructor(chip, pio, before) {
    this.chip = chip;
    this.pio = pio;
    /** `well`, `silent` (no conversion), `shorted` (DOUT to ground), `saturated` or `stuck` (one code). */
    this.state = before?.state ?? 'well';
    this.integral = 0;
    this.pulses = 0;
    this.data(true);
    chip.rp2040.gpio[PIN.clock].addListener(() => this.clocked(chip.rp2040.gpio[PIN.clock].outputValue));
  }

  /** The bench was at these codes since the last call. */
  pass(nowNs, codes) {
    if (this.marks === undefined) {
      this.marks = Array.from({ length: SETTLING + 1 }, () => ({ atNs: nowNs, integral: 0 }));
      [this.atNs, this.nextNs] = [nowNs, nowNs + CONVERSION_NS];
    }
    this.integral += codes * (nowNs - this.atNs);
    this.atNs = nowNs;
    if (this.state === 'shorted') this.show(false);
    if (nowNs < this.nextNs) return;
    this.nextNs += CONVERSION_NS;
    if (this.isOff || this.state === 'silent') return;
    this.marks.push({ atNs: nowNs, integral: this.integral });
    const since = this.marks.shift();
    const mean = (this.integral - since.integral) / (nowNs - since.atNs);
    const code = this.state === 'stuck' ? this.code : Math.round(mean + NOISE_CODES * this.normal());
    const isBeyond = this.state === 'saturated' || code > 0x7fffff;
    this.code = isBeyond ? 0x7fffff : Math.max(-0x800000, code);
    this.pulses = 0;
    this.show(false);
  }

  /** A level of PD_SCK. */
  clocked(isHigh) {
    const machine = this.pio.pio.machines[0];
    const atUs = (machine.cycles * (machine.clockDivInt + machine.clockDivFrac / 256)) / CYCLES_PER_US;
    if (!isHigh) {
      if (atUs - this.roseUs > OFF_AFTER_US) this.isOff = true;
      return;
    }
    this.roseUs = atUs;
    this.pulses += 1;
    if (this.isOff) return;
    this.data(this.pulses > BITS || ((this.code >> (BITS - this.pulses)) & 1) !== 0);
  }

  /** Changes DOUT at a time of the chip: what came before is brought up to the present first. */
  show(isHigh) {
    this.pio.catchUp();
    this.data(isHigh);
  }

  data(isHigh) {
    this.chip.rp2040.gpio[PIN.data].setInputValue(isHigh && this.state !== 'shorted');
  }

  /** Normally distributed, from a sequence that is the same in every run. */
  normal() {
    this.seed = this.seed ?? 1;
    let sum = -6;
    for (let i = 0; i < 12; i += 1) {
      this.seed = (Math.imul(this.seed, 1664525) + 1013904223) >>> 0;
      sum += this.seed / 2 ** 32;
    }
    return sum;
  }
}
