// The converters at the level of their registers and of the bytes on their buses (data sheets SBAS582C and AD5761R Rev. C).

/** ADS8688: `voltage(channel)` is asked when chip select falls. */
export class Ads8688 {
  constructor(voltage) {
    this.voltage = voltage;
    this.fault = null;
    this.forced = new Map();
    this.reset();
  }

  reset() {
    this.registers = new Uint8Array(128);
    this.selected = null;
    this.frame = [];
    this.answer = new Uint8Array(6);
  }

  select(isLow) {
    if (isLow) this.begin();
    else this.end();
  }

  begin() {
    this.frame = [];
    if (this.fault === 'frozen') return;
    this.answer = new Uint8Array(6);
    if (this.selected === null) return;
    const channel = this.selected;
    const range = this.registers[5 + channel];
    const fullScale = [10.24, 5.12, 2.56][range] ?? 10.24;
    if (this.fault !== 'stuck' || this.code === undefined) {
      const code = Math.floor(((this.forced.get(channel) ?? this.voltage(channel)) / fullScale) * 32768 + 0.5) + 32768;
      this.code = Math.min(65535, Math.max(0, code));
    }
    const format = this.registers[3] & 7;
    const tail = format === 3 ? (channel << 4) | (range >> 1) : 0;
    const end = format === 3 ? (range & 1) << 7 : 0;
    this.answer.set([0, 0, this.code >> 8, this.code & 255, tail, end]);
  }

  byte(value) {
    this.frame.push(value);
    const place = this.frame.length - 1;
    if (this.fault === 'low') return 0;
    if (this.fault === 'high') return 255;
    const [command] = this.frame;
    if (place === 2 && this.fault !== 'frozen' && command > 0 && command < 0x80) return this.register();
    return this.answer[place] ?? 0;
  }

  /** A program register: seven bits of address, then write or read. */
  register() {
    const [command, data] = this.frame;
    const address = command >> 1;
    if (command & 1) this.registers[address] = data;
    return this.registers[address];
  }

  end() {
    const [command] = this.frame;
    if (this.fault === 'low' || this.fault === 'high' || command === undefined) return;
    if (command === 0x85) this.reset();
    else if (command >= 0xc0 && command < 0xe0 && (command & 3) === 0) this.selected = (command - 0xc0) >> 2;
  }
}

/** AD5761R: calls `changed(volts)` when its output does. */
export class Ad5761r {
  constructor(changed) {
    this.changed = changed;
    this.fault = null;
    this.volts = 0;
    this.reset();
  }

  /** Its RESET pin: while low, and until the control register is written, the output is clamped to ground. */
  reset() {
    this.inReset = true;
    this.control = null;
    this.code = 0;
    this.frame = [];
    this.answer = [0, 0, 0];
    this.output(0);
  }

  release() {
    this.inReset = false;
  }

  select(isLow) {
    if (isLow) this.frame = [];
    else if (!this.inReset && this.fault === null) this.end();
  }

  byte(value) {
    this.frame.push(value);
    if (this.inReset || this.fault === 'low') return 0;
    if (this.fault === 'high') return 255;
    return this.answer[this.frame.length - 1] ?? 0;
  }

  end() {
    if (this.frame.length !== 3) return;
    const [address, high, low] = this.frame;
    const data = (high << 8) | low;
    this.answer = [address, high, low];
    switch (address & 0x1f) {
      case 0x3:
        if (this.control !== null) this.update(data);
        break;
      case 0x4:
        this.control = data & 0x7ff;
        this.update([0, 0x8000, 0xffff, 0xffff][(data >> 3) & 3]);
        break;
      case 0xb:
        this.answer = [0xb, this.code >> 8, this.code & 255];
        break;
      case 0xc:
        this.answer = [0xc, (this.control ?? 0) >> 8, (this.control ?? 0) & 255];
        break;
      case 0xf:
        this.reset();
        this.inReset = false;
        break;
    }
  }

  update(code) {
    this.code = code;
    const range = this.control & 7;
    // The firmware's range; any other would be its mistake.
    this.output(range === 0 ? ((code - 32768) / 32768) * 10 : NaN);
  }

  output(volts) {
    if (volts === this.volts) return;
    this.volts = volts;
    this.changed(volts);
  }
}
