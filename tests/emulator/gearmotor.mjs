// The gearmotor board: chip, encoders, bridge, currents and cable as docs/gearmotor.md wires them, at a bench.
//
// The bridge and what it drives are means over a period of its modulation, which begins with the duty that the chip has for it. Within a
// period angles, currents and the supply go in straight lines.

import { readSync, writeSync } from 'node:fs';
import { Board } from './board.mjs';
import { Converter } from './converter.mjs';
import { Hx711 } from './hx711.mjs';
import { Pio } from './pio.mjs';

const PIN = { encoders: [6, 8], index: 10, bridge: [16, 17], stop: 15 };
const MODULATED = 4;
const PERIOD_CYCLES = 6250;
const PERIOD_NS = 50_000;
const STATE_BYTES = 40;
// A duty lasts a sampling interval, mostly: so many periods are asked for at once.
const MOST_PERIODS = 20;
const SUPPLY = 2;
// What the torque transducer's converter is at, in codes; volts where the bench has the supply's current instead.
const TORQUE = 1;
const SUPPLY_DIVIDER = 6;
// The modulation's register of both inputs' times.
const COMPARE = 0x0c;
const FULL_SCALE_V = 3.3;
// Of the motor's encoder and of the output's.
const COUNTS_PER_TURN = [1024, 2400];
// Tracks A (1) and B (2) in the order of the counts.
const TRACKS = [0, 1, 3, 2];

/** Winding, gear and load, which another process integrates: asked over standard input and output, one message at a time. */
class Bench {
  constructor() {
    this.message = Buffer.alloc(25);
  }

  /** Some periods with the bridge at a duty, or off (null): the state at the end of each, of which the first is at `atNs`. */
  step(atNs, duty, periods) {
    this.message.write('g', 0, 'latin1');
    this.message.writeDoubleLE(atNs * 1e-9, 1);
    this.message.writeDoubleLE(duty ?? 0, 9);
    this.message.writeDoubleLE(duty === null ? -periods : periods, 17);
    writeSync(1, this.message);
    const reply = Buffer.alloc(STATE_BYTES * periods);
    for (let got = 0; got < reply.length; ) {
      const count = readSync(0, reply, got, reply.length - got);
      if (count === 0) process.exit(0);
      got += count;
    }
    return Array.from({ length: periods }, (_, period) => {
      const numbers = Array.from({ length: 5 }, (_, place) => reply.readDoubleLE(STATE_BYTES * period + 8 * place));
      return { atNs: atNs + PERIOD_NS * period, turns: numbers.slice(0, 2).map((rad) => rad / (2 * Math.PI)), volts: numbers.slice(2) };
    });
  }
}

export class GearmotorBoard extends Board {
  create() {
    this.bench = new Bench();
    this.forced = new Map();
    this.encoder = 'well';
    // At power-on each shaft stands in the middle of a count.
    this.counts = [0, 0];
    this.directions = [0, 0];
    // Ends of the periods that conversions in the converter's ring may be of, up to that of the present one.
    const rest = { atNs: 0, turns: [0, 0], volts: [1.65, 1.65, 2] };
    this.states = [rest, rest, rest, rest];
    this.ahead = [];
    this.hx711 = undefined;
    this.ticks = { wraps: 0, changedAt: 0, interval: MOST_PERIODS, duty: null };
  }

  attach() {
    const { rp2040, clock } = this.chip;
    this.pio = new Pio(this.chip, 0, () => this.read());
    this.hx711 = new Hx711(this.chip, new Pio(this.chip, 1, () => {}), this.hx711);
    const slice = rp2040.pwm.channels[0];
    const wrap = slice.wrap.bind(slice);
    slice.wrap = () => {
      wrap();
      this.period(slice);
    };
    const write = slice.writeRegister.bind(slice);
    slice.writeRegister = (offset, value) => {
      write(offset, value);
      if (offset !== COMPARE) return;
      this.writes = (this.writes ?? 0) + 1;
      if (this.enabled) this.peakV = Math.max(this.peakV ?? 0, Math.abs(this.volts));
    };
    this.converter = new Converter(this.chip, (channel, atNs) => this.code(channel, atNs));
    this.edges = this.counts.map((_, number) => clock.createAlarm(() => this.edge(number)));
    this.counts.forEach((_, number) => this.show(number));
  }

  wires() {}

  /** Beginning and end of the present period. */
  get before() {
    return this.states.at(-2);
  }

  get after() {
    return this.states.at(-1);
  }

  keep(state) {
    this.states.shift();
    this.states.push(state);
  }

  release() {
    this.chip.rp2040.gpio[PIN.stop].setInputValue(this.stopClosed);
  }

  commanded() {}

  /** The voltage that the bridge was last told to apply: its duty of the supply. */
  get volts() {
    const { cc } = this.chip.rp2040.pwm.channels[0];
    const [first, second] = [cc & 0xffff, cc >>> 16];
    return ((first - second) / PERIOD_CYCLES) * this.after.volts[SUPPLY] * SUPPLY_DIVIDER;
  }

  /** The processor reads an encoder: the first of the two is where a conversion begins. */
  read() {
    if (this.conversions === 0 && this.enabled) this.sampling.instants.push(this.nanos);
    this.conversions += 1;
  }

  /** What the converter makes of an input at a time of the chip's. */
  code(channel, chipNs) {
    const atNs = this.epochNs + chipNs;
    let volts = this.forced.get(channel);
    if (volts === undefined) {
      const later = this.states.findIndex((state, place) => place > 0 && state.atNs >= atNs);
      const [from, to] = later < 0 ? this.states.slice(-2) : this.states.slice(later - 1, later + 1);
      const share = to.atNs > from.atNs ? Math.min(1, (atNs - from.atNs) / (to.atNs - from.atNs)) : 1;
      volts = from.volts[channel] + (to.volts[channel] - from.volts[channel]) * share;
    }
    return Math.min(4095, Math.max(0, Math.floor((volts / FULL_SCALE_V) * 4096)));
  }

  /** A period of the modulation begins, with the duty that the chip has taken for it. */
  period(slice) {
    const now = this.nanos;
    // After a reset, and before the first period.
    if (now - this.after.atNs > 1) {
      this.keep(this.bench.step(now, null, 1)[0]);
      this.ahead = [];
    }
    const [first, second] = [slice.alarmA, slice.alarmB].map(({ target }) => Math.min(target, PERIOD_CYCLES) / PERIOD_CYCLES);
    const isModulated = PIN.bridge.every((pin) => this.chip.rp2040.gpio[pin].functionSelect === MODULATED);
    // Where neither input stays high, the bridge is open between two pulses. Taken for open all the time, it moves nothing.
    const brakes = Math.max(first, second) === 1;
    const duty = this.enabled && isModulated && brakes ? first - second : null;
    this.count(duty);
    if (this.ahead.length === 0) this.ahead = this.bench.step(now + PERIOD_NS, duty, this.foreseen());
    this.keep(this.ahead.shift());
    this.hx711.pass(now, this.before.volts[TORQUE]);
    this.counts.forEach((_, number) => this.plan(number));
  }

  /**
   * For how many periods a duty will last, at least: duties change at ticks, so until the next of these, give or take a period where the tick
   * writes near a period's end. A change that comes at another time takes effect up to a sampling interval late.
   */
  foreseen() {
    const { wraps, changedAt, interval } = this.ticks;
    const place = (wraps - changedAt) % interval;
    const mayHaveChanged = place === 0 && wraps > changedAt;
    return mayHaveChanged ? 1 : Math.max(1, interval - 1 - place);
  }

  /** A period begins at this duty. */
  count(duty) {
    const { ticks } = this;
    ticks.wraps += 1;
    if (duty === ticks.duty) return;
    ticks.interval = Math.min(MOST_PERIODS, ticks.wraps - ticks.changedAt);
    Object.assign(ticks, { duty, changedAt: ticks.wraps });
  }

  /** Schedules an encoder's next edge of this period, if the shaft leaves the present count in it. */
  plan(number) {
    const [from, to] = [this.before, this.after].map(({ turns }) => turns[number] * COUNTS_PER_TURN[number] + 0.5);
    const count = this.counts[number];
    const direction = Math.sign(Math.floor(to) - count);
    if (direction === 0) {
      this.edges[number].cancel();
      return;
    }
    const share = ((direction > 0 ? count + 1 : count) - from) / (to - from);
    const atNs = this.before.atNs + Math.min(1, Math.max(0, share)) * PERIOD_NS;
    this.directions[number] = direction;
    this.edges[number].schedule(Math.max(0, atNs - this.nanos));
  }

  edge(number) {
    this.counts[number] += this.directions[number];
    this.show(number);
    this.plan(number);
  }

  /** Puts an encoder's tracks on its pins, and the motor's index on its own. */
  show(number) {
    const { gpio } = this.chip.rp2040;
    const count = this.counts[number];
    this.pio.catchUp();
    if (number === 0) {
      gpio[PIN.index].setInputValue(count % COUNTS_PER_TURN[0] === 0);
      if (this.encoder === 'silent') return;
    }
    const tracks = TRACKS[((count % 4) + 4) % 4];
    const isSwapped = number === 0 && this.encoder === 'swapped';
    const first = PIN.encoders[number];
    gpio[first + (isSwapped ? 1 : 0)].setInputValue((tracks & 1) !== 0);
    gpio[first + (isSwapped ? 0 : 1)].setInputValue((tracks & 2) !== 0);
  }

  happen(what) {
    const [kind, value] = what.split('=');
    switch (kind) {
      case 'encoder':
        this.note('injected', what);
        this.encoder = value;
        break;
      case 'reading': {
        // Without a voltage the input is as it should be.
        this.note('injected', what);
        const [channel, volts] = value.split('@').map(Number);
        if (volts === undefined) this.forced.delete(channel);
        else this.forced.set(channel, volts);
        break;
      }
      case 'transducer':
        this.note('injected', what);
        this.hx711.state = value;
        break;
      case 'supply':
        this.note('injected', what);
        if (value === 'gone') this.forced.set(SUPPLY, 0);
        else this.forced.delete(SUPPLY);
        break;
      default:
        super.happen(what);
    }
  }
}
