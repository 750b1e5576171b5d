// The board: chip, converters, lines and cable as docs/firmware.md wires them, at a bench.

import { Ad5761r, Ads8688 } from './converters.mjs';
import { Bench } from './bench.mjs';
import { Cause, Chip, CYCLE_NS, WatchdogBite } from './chip.mjs';
import { breakProgram } from './program.mjs';
import { UsbHost } from './usb.mjs';

const PIN = { alive: 2, inputSelect: 17, outputSelect: 13, outputReset: 14, stop: 15, strap: 20, feedback: 21, enable: 22, cable: 24, light: 25 };
const SAMPLING = 1;
// The external watchdog: a retriggerable monostable at the alive line, which gates the enable line.
const GUARD_NS = 2e6;
const FLASH_XOR = 1;
const LEVEL = { high: true, low: false, well: null };

export class Board {
  /** `image`: an ELF file, for its symbols; `flash`: what is flashed. `heard(bytes)`: what the board said to its host. */
  constructor(image, flash, heard) {
    this.image = image;
    this.flash = flash;
    this.damaged = [];
    this.heard = heard;
    this.create();
    this.stopClosed = true;
    this.plugged = true;
    // Where the enable line is held: at the Pico's pad, and at the drive.
    this.padHeld = null;
    this.driveHeld = null;
    // Whether a wire brings the drive's line back.
    this.hasFeedback = false;
    this.enabled = false;
    this.log = [];
    this.plans = [];
    this.epochNs = 0;
    this.boot(Cause.POWER);
  }

  /** What is on the board beside the chip, and what it is wired to. */
  create() {
    this.bench = new Bench();
    this.input = new Ads8688((channel) => this.bench.voltage(this.seconds, channel));
    this.output = new Ad5761r(() => this.commanded());
  }

  /** Connects it to a chip that starts. */
  attach(cause) {
    if (cause === Cause.POWER || cause === Cause.BROWN_OUT) {
      this.input.reset();
      this.output.reset();
    }
    const { rp2040 } = this.chip;
    rp2040.spi[0].chip = this.input;
    rp2040.spi[1].chip = this.output;
  }

  /** Lines that only this board has. */
  wires() {
    this.wire(PIN.inputSelect, (high) => this.select(this.input, high));
    this.wire(PIN.outputSelect, (high) => {
      this.output.select(!high);
      this.writes = (this.writes ?? 0) + (high ? 1 : 0);
    });
    this.wire(PIN.outputReset, () => this.lines());
  }

  get nanos() {
    return this.epochNs + this.chip.nanos;
  }

  get seconds() {
    return this.nanos * 1e-9;
  }

  /** Starts the chip. What it drove until now falls to its pull-downs. */
  boot(cause) {
    if (this.chip) this.epochNs += this.chip.nanos;
    this.chip = new Chip(this.flash, cause, this.chip);
    for (const offset of this.damaged) this.chip.rp2040.flash[offset] ^= FLASH_XOR;
    this.attach(cause);
    const { rp2040 } = this.chip;
    this.usb = new UsbHost(this.chip, (bytes) => this.said(bytes));
    this.lines();
    this.wires();
    this.wire(PIN.enable, () => this.lines());
    const guard = this.chip.clock.createAlarm(() => this.guard(false));
    this.wire(PIN.alive, () => {
      guard.schedule(GUARD_NS);
      this.guard(true);
    });
    this.wire(PIN.light, (high) => high !== this.lit && this.note('light', (this.lit = high)));
    rp2040.gpio[PIN.strap].setInputValue(!this.hasFeedback);
    rp2040.gpio[PIN.cable].setInputValue(this.plugged);
    if (this.plugged) this.usb.plug();
    this.measure();
    this.note('boot', cause);
  }

  /** The output's voltage. */
  get volts() {
    return this.output.volts;
  }

  wire(pin, changed) {
    this.chip.rp2040.gpio[pin].addListener(() => changed(this.isHigh(pin)));
  }

  /** A line with a pull-down. */
  isHigh(pin) {
    const { outputEnable, outputValue } = this.chip.rp2040.gpio[pin];
    return outputEnable && outputValue;
  }

  /** The emergency stop's second contact, in the output converter's reset line. */
  release() {
    const released = this.stopClosed && this.isHigh(PIN.outputReset);
    if (released) this.output.release();
    else this.output.reset();
    this.chip.rp2040.gpio[PIN.stop].setInputValue(released);
  }

  /** The emergency stop's two contacts; the first one is in the drive's enable line. */
  lines() {
    this.release();
    const pad = this.padHeld ?? this.isHigh(PIN.enable);
    const guarded = !this.hasGuard || this.isAlive;
    const enabled = this.driveHeld ?? (this.stopClosed && pad && guarded);
    this.chip.rp2040.gpio[PIN.enable].setInputValue(pad);
    this.chip.rp2040.gpio[PIN.feedback].setInputValue(enabled);
    if (enabled !== this.enabled) {
      this.enabled = enabled;
      this.note('enable', enabled);
      this.commanded();
      if (enabled) this.plans.filter((plan) => plan.afterS != null).forEach((plan) => this.due(plan));
    }
  }

  guard(isAlive) {
    if (this.isAlive === isAlive) return;
    this.isAlive = isAlive;
    if (this.hasGuard) this.lines();
  }

  /** What the board says; where it is to lose its cable within a frame, that happens after a packet that does not end one. */
  said(bytes) {
    this.heard(bytes);
    if (this.pullInFrame && bytes.at(-1) !== 0) {
      this.pullInFrame = false;
      this.happen('pull-cable');
    }
  }

  commanded() {
    this.bench.command(this.seconds, this.output.volts, this.enabled);
    this.peakV = Math.max(this.peakV ?? 0, Math.abs(this.output.volts));
    if (this.output.volts === 0 || this.wasZero) this.note('volts', this.output.volts);
    this.wasZero = this.output.volts === 0;
  }

  note(what, value) {
    this.log.push({ ns: Math.round(this.nanos), what, value });
  }

  // Measuring.

  measure() {
    this.resetMeasure();
    this.chip.watchInterrupt(
      SAMPLING,
      () => {
        this.conversions = 0;
      },
      (cycles) => {
        const { sampling } = this;
        if (!this.enabled) sampling.worstIdle = Math.max(sampling.worstIdle, cycles);
        else if (this.conversions > 0) {
          sampling.count += 1;
          sampling.total += cycles;
          sampling.worst = Math.max(sampling.worst, cycles);
        }
      },
    );
  }

  /** Forgets what was measured. */
  resetMeasure() {
    this.sampling = { count: 0, worst: 0, worstIdle: 0, total: 0, instants: [], stepNs: 0 };
  }

  /** Chip select of the inputs. */
  select(converter, high) {
    converter.select(!high);
    if (high) return;
    const { instants } = this.sampling;
    if (this.conversions === 0 && this.enabled) instants.push(this.nanos);
    if (this.conversions === 1 && this.enabled) this.sampling.stepNs = Math.max(this.sampling.stepNs, this.nanos - instants.at(-1));
    this.conversions += 1;
  }

  /**
   * What was measured while the drive was enabled, and how long the interrupt took at most while it was not (when requests are
   * allowed that take their time); `stepUs` is the time between conversions.
   */
  measured(stepUs) {
    const { count, worst, worstIdle, total, instants, stepNs } = this.sampling;
    const period = stepUs * 1000;
    const phase = instants.map((instant) => {
      const turn = (instant - instants[0]) % period;
      return turn > period / 2 ? turn - period : turn;
    });
    const earliest = phase.reduce((a, b) => Math.min(a, b), 0);
    const latest = phase.reduce((a, b) => Math.max(a, b), 0);
    return {
      conversions: count,
      worstCycles: worst,
      worstIdleCycles: worstIdle,
      meanCycles: count > 0 ? total / count : 0,
      spreadNs: latest - earliest,
      channelStepNs: stepNs,
      stackBytes: this.chip.stackUsed(),
      cycleNs: CYCLE_NS,
    };
  }

  // What can happen to it.

  /** `{ what, afterS }`: so long after the drive was enabled next; without `afterS` at once. */
  inject(plan) {
    if (plan.afterS == null) this.happen(plan.what);
    else this.plans.push(plan);
  }

  due(plan) {
    const ns = plan.afterS * 1e9;
    plan.afterS = null;
    this.chip.clock.createAlarm(() => {
      this.plans = this.plans.filter((other) => other !== plan);
      this.happen(plan.what);
    }).schedule(ns);
  }

  happen(what) {
    this.note('injected', what);
    const [kind, value] = what.split('=');
    switch (kind) {
      case 'pull-cable':
        this.plugged = false;
        this.usb.pull();
        this.chip.rp2040.gpio[PIN.cable].setInputValue(false);
        break;
      case 'plug-cable':
        this.plugged = true;
        this.chip.rp2040.gpio[PIN.cable].setInputValue(true);
        this.usb.plug();
        break;
      case 'input':
        this.input.fault = value === 'well' ? null : value;
        break;
      case 'reading': {
        // Without a voltage the sensor reads as it should.
        const [channel, volts] = value.split('@').map(Number);
        if (volts === undefined) this.input.forced.delete(channel);
        else this.input.forced.set(channel, volts);
        break;
      }
      case 'output':
        this.output.fault = value === 'well' ? null : value;
        break;
      case 'open-stop':
        this.stopClosed = false;
        this.lines();
        break;
      case 'close-stop':
        this.stopClosed = true;
        this.lines();
        break;
      case 'both':
        this.input.fault = this.output.fault = value === 'well' ? null : value;
        break;
      case 'pad':
        this.padHeld = LEVEL[value];
        this.lines();
        break;
      case 'drive':
        this.driveHeld = LEVEL[value];
        this.lines();
        break;
      case 'wire-feedback':
        this.hasFeedback = true;
        this.restart = Cause.POWER;
        break;
      case 'fit-guard':
        this.hasGuard = true;
        this.lines();
        break;
      case 'slow':
        this.chip.slow(Number(value));
        break;
      case 'stop-crystal':
        this.chip.stopCrystal();
        break;
      case 'damage-flash':
        this.damaged.push(Number(value));
        this.restart = Cause.POWER;
        break;
      case 'pull-in-frame':
        this.pullInFrame = true;
        break;
      case 'hang':
        this.chip.frozen = true;
        break;
      case 'halt':
        this.chip.halt();
        break;
      case 'press-reset':
        this.restart = Cause.PIN;
        break;
      case 'brown-out':
        this.restart = Cause.BROWN_OUT;
        break;
      case 'power-off':
        this.restart = Cause.POWER;
        break;
      case 'panic':
      case 'hard-fault':
      case 'overflow':
        breakProgram(this.chip, this.image, kind, value);
        break;
      case 'host':
        this.hostSays = value;
        break;
      default:
        throw new Error(`nothing is known of ${what}`);
    }
  }

  /** Bytes that no host says, at a random instant of the coming `withinNs`. */
  chatter(withinNs) {
    const bytes = Uint8Array.from({ length: 1 + Math.floor(Math.random() * 200) }, () => Math.floor(Math.random() * 256));
    this.chip.clock.createAlarm(() => this.usb.say(bytes)).schedule(Math.random() * withinNs);
  }

  /** Lets so much time pass. */
  runFor(nanos) {
    const until = this.nanos + nanos;
    while (this.nanos < until) {
      try {
        // Short pieces: a reset from outside takes effect between them.
        this.chip.runUntil(Math.min(until - this.epochNs, this.chip.nanos + 10_000));
        if (this.restart !== undefined) {
          const cause = this.restart;
          this.restart = undefined;
          this.boot(cause);
        }
      } catch (bite) {
        if (!(bite instanceof WatchdogBite)) throw bite;
        this.boot(Cause.WATCHDOG);
      }
    }
  }
}
