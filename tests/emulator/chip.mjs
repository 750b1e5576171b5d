// The microcontroller: rp2040js with the gaps cured that this firmware would fall into.
//
// Cured here: alarms ring at the exact microsecond; SPI takes its clock edges; taking and leaving an interrupt takes cycles; SEV
// wakes; the reset register exists; a watchdog reset ends the run instead of looping. Not modelled: misses of the flash's cache, the
// second core.

import { RP2040 } from 'rp2040js';
import { load } from './elf.mjs';

const FLASH = 0x10000000;
const RAM = 0x20000000;
const VECTORS = 0x10000100;
export const CYCLE_NS = 8;

// Cortex-M0+ with memory that does not wait: 15 cycles to the first instruction of an interrupt, 13 back.
const ENTRY_CYCLES = 15;
const RETURN_CYCLES = 13;

// A word that no program writes by chance: where it still stands, the stack has never been.
const PAINT = 0xa5c3_96e1;

const WATCHDOG = 0x40058;
const TIMER = 0x40054;
const MPU_CTRL = 0xd94;
const MPU_RBAR = 0xd9c;
const MPU_RASR = 0xda0;
const CHIP_RESET = 0x40064;

/** Why the chip starts. */
export const Cause = { POWER: 'power', BROWN_OUT: 'brown-out', PIN: 'pin', WATCHDOG: 'watchdog' };

/** Thrown out of the instruction that lets the watchdog bite. */
export class WatchdogBite extends Error {}

export class Chip {
  /** `image`: an ELF or UF2 file. `before`: the chip before a reset, whose watchdog remembers. */
  constructor(image, cause, before) {
    this.rp2040 = new RP2040();
    this.clock = this.rp2040.clock;
    this.core = this.rp2040.core;
    this.interrupts = new Map();
    this.frozen = false;
    this.cycleNs = CYCLE_NS;
    const { rp2040, core } = this;
    rp2040.logger = quiet(core);
    rp2040.clkSys = rp2040.clkPeri = 125e6;
    // Only a long loss of the supply is lost on the memory.
    if (before && cause !== Cause.POWER) rp2040.sram.set(before.rp2040.sram);
    else for (let address = 0; address < rp2040.sram.length; address += 4) rp2040.sramView.setUint32(address, PAINT, true);
    load(image, (address, bytes) => {
      if (address >= FLASH && address < RAM) rp2040.flash.set(bytes, address - FLASH);
    });
    core.VTOR = VECTORS;
    core.reset();
    this.cureTimer();
    this.cureSpi();
    this.cureInterrupts();
    this.cureResets(cause, before);
    this.cureGuard();
  }

  get nanos() {
    return this.clock.nanos;
  }

  /** Runs up to this time. */
  runUntil(nanos) {
    const { core, clock } = this;
    while (clock.nanosCounter < nanos) {
      if (core.waiting || this.frozen) {
        const next = clock.nextAlarm ? clock.nextAlarm.nanos : nanos;
        clock.tick(Math.max(0, Math.min(next, nanos) - clock.nanosCounter));
      } else {
        const cycles = core.executeInstruction() + this.extraCycles;
        this.extraCycles = 0;
        const now = clock.nanosCounter + cycles * this.cycleNs;
        if (clock.nextAlarm !== null && clock.nextAlarm.nanos <= now) clock.tick(cycles * this.cycleNs);
        else clock.nanosCounter = now;
      }
    }
  }

  /** Bytes of the stack that were ever used; it grows down to the beginning of the memory. */
  stackUsed() {
    const { sramView } = this.rp2040;
    let free = 0;
    while (sramView.getUint32(free, true) === PAINT) free += 4;
    return this.rp2040.readUint32(VECTORS) - RAM - free;
  }

  /** A debugger halts the processor. */
  halt() {
    const watchdog = this.rp2040.peripherals[WATCHDOG];
    if (watchdog.pauseDbg0 || watchdog.pauseDbg1 || watchdog.pauseJtag) watchdog.timer.enable = watchdog.alarm.enable = false;
    this.frozen = true;
  }

  /** The processor's clock is so many times slower than it should be; the crystal's, which the timer counts, is not. */
  slow(factor) {
    this.cycleNs = CYCLE_NS * factor;
    this.rp2040.ppb.systickTimer.frequency = 125e6 / factor;
  }

  /** The crystal stops, and all that counts it: processor, timer, watchdog. */
  stopCrystal() {
    const watchdog = this.rp2040.peripherals[WATCHDOG];
    watchdog.timer.enable = watchdog.alarm.enable = false;
    this.frozen = true;
  }

  /** Calls `act()` as soon as the processor is in an exception (by its number), or in none (0). */
  within(exception, act) {
    if (this.core.IPSR === exception) act();
    else this.awaited = { exception, act };
  }

  arrived() {
    if (this.awaited?.exception !== this.core.IPSR) return;
    const { act } = this.awaited;
    this.awaited = undefined;
    act();
  }

  /** Calls `entered()` and `left(cycles)` around every run of the handler of an interrupt. */
  watchInterrupt(number, entered, left) {
    this.interrupts.set(16 + number, { entered, left, since: 0 });
  }

  cureTimer() {
    const timer = this.rp2040.peripherals[TIMER];
    const { clock } = this;
    const write = timer.writeUint32.bind(timer);
    timer.writeUint32 = (offset, value) => {
      write(offset, value);
      if (offset < 0x10 || offset > 0x1c) return;
      const now = Math.floor(clock.nanos / 1000);
      const rings = (now + ((value - now) >>> 0)) * 1000;
      timer.alarms[(offset - 0x10) / 4].clockAlarm.schedule(Math.max(0, rings - clock.nanos));
    };
  }

  cureSpi() {
    for (const spi of this.rp2040.spi) {
      let answer = 0;
      const done = this.clock.createAlarm(() => spi.completeTransmit(answer));
      spi.chip = { byte: () => 0 };
      spi.onTransmit = (value) => {
        answer = spi.chip.byte(value);
        done.schedule((spi.dataBits / spi.clockFrequency) * 1e9);
      };
    }
  }

  cureInterrupts() {
    const { core } = this;
    this.extraCycles = 0;
    const enter = core.exceptionEntry.bind(core);
    core.exceptionEntry = (number) => {
      enter(number);
      this.extraCycles += ENTRY_CYCLES;
      const watched = this.interrupts.get(number);
      if (watched) {
        watched.since = this.clock.nanos;
        watched.entered();
      }
      this.arrived();
    };
    const leave = core.exceptionReturn.bind(core);
    core.exceptionReturn = (value) => {
      const watched = this.interrupts.get(core.IPSR);
      leave(value);
      this.extraCycles += RETURN_CYCLES;
      this.arrived();
      if (watched) watched.left(Math.round((this.clock.nanos - watched.since) / CYCLE_NS) + ENTRY_CYCLES + RETURN_CYCLES);
    };
  }

  /** The memory protection unit, as far as one region without any access goes: writing there locks the processor up. */
  cureGuard() {
    const { rp2040 } = this;
    const registers = new Map();
    const write = rp2040.ppb.writeUint32.bind(rp2040.ppb);
    rp2040.ppb.writeUint32 = (offset, value) => {
      if (offset >= MPU_CTRL && offset <= MPU_RASR) registers.set(offset, value);
      else write(offset, value);
    };
    const [ctrl, rbar, rasr] = [MPU_CTRL, MPU_RBAR, MPU_RASR].map((offset) => () => registers.get(offset) ?? 0);
    const forbidden = (address) => {
      const isOn = ctrl() & 1 && rasr() & 1 && ((rasr() >> 24) & 7) === 0;
      const size = 2 ** (((rasr() >> 1) & 31) + 1);
      const base = (rbar() & ~31) >>> 0;
      return isOn && address >= base && address < base + size;
    };
    const { warn } = rp2040.logger;
    rp2040.logger.warn = (name, message) => {
      const [, address] = /^Write to undefined address: ([0-9a-f]+)/.exec(message) ?? [];
      if (address !== undefined && forbidden(parseInt(address, 16))) this.frozen = true;
      warn(name, message);
    };
  }

  cureResets(cause, before) {
    const { peripherals } = this.rp2040;
    const watchdog = peripherals[WATCHDOG];
    watchdog.onWatchdogTrigger = () => {
      throw new WatchdogBite();
    };
    // A reset from outside clears what the watchdog keeps over its own.
    if (cause === Cause.WATCHDOG) {
      const old = before.rp2040.peripherals[WATCHDOG];
      watchdog.reason = old.reason;
      watchdog.scratchData.set(old.scratchData);
    }
    const hadRun = cause === Cause.PIN ? 1 << 16 : 0;
    const hadPower = cause === Cause.POWER || cause === Cause.BROWN_OUT ? 1 << 8 : 0;
    peripherals[CHIP_RESET] = {
      readUint32: (offset) => (offset === 8 ? hadRun | hadPower : 0),
      writeUint32Atomic: () => {},
    };
  }
}

function quiet(core) {
  const nothing = () => {};
  return {
    debug: nothing,
    warn: nothing,
    error: (name, message) => process.stderr.write(`${name}: ${message}\n`),
    info: (name, message) => {
      if (message === 'SEV') core.eventRegistered = true;
    },
  };
}
