// The drivetrain, which another process integrates: asked and told over standard input and output, one message at a time.

import { readSync, writeSync } from 'node:fs';

const CHANNELS = 4;

/** Between two askings voltages go on in a straight line: channels are converted a few microseconds apart. */
const KNOWN_FOR_S = 50e-6;

export class Bench {
  constructor() {
    this.message = Buffer.alloc(25);
    this.reply = Buffer.alloc(8 * CHANNELS);
    this.volts = new Float64Array(CHANNELS);
    this.slopes = new Float64Array(CHANNELS);
    this.atS = 0;
  }

  /** The drive's command and enable line, from this time on. */
  command(atS, volts, enabled) {
    this.send('c', atS, volts, enabled);
  }

  /** A sensor's voltage. */
  voltage(atS, channel) {
    if (atS - this.atS > KNOWN_FOR_S) this.ask(atS);
    return this.volts[channel] + this.slopes[channel] * (atS - this.atS);
  }

  ask(atS) {
    this.send('s', atS, 0, false);
    for (let got = 0; got < this.reply.length; ) {
      const count = readSync(0, this.reply, got, this.reply.length - got);
      if (count === 0) process.exit(0);
      got += count;
    }
    for (let channel = 0; channel < CHANNELS; channel += 1) {
      const volts = this.reply.readDoubleLE(8 * channel);
      this.slopes[channel] = (volts - this.volts[channel]) / (atS - this.atS);
      this.volts[channel] = volts;
    }
    this.atS = atS;
  }

  send(kind, atS, volts, enabled) {
    this.message.write(kind, 0, 'latin1');
    this.message.writeDoubleLE(atS, 1);
    this.message.writeDoubleLE(volts, 9);
    this.message.writeDoubleLE(enabled ? 1 : 0, 17);
    writeSync(1, this.message);
  }
}
