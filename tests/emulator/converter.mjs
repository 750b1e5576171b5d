// The converter of the RP2040 as it runs by itself, and the transfer of its conversions to a ring in memory: computed when the processor looks at
// either. rp2040js would wake twice for each of half a million conversions a second, and takes its turns with a wrong mask.

const CLOCK_HZ = 48e6;
const START_MANY = 1 << 3;
const TRANSFER = 0;

export class Converter {
  /** `code(input, atNs)`: what an input was converted to. */
  constructor(chip, code) {
    this.chip = chip;
    this.code = code;
    this.adc = chip.rp2040.adc;
    this.transfer = chip.rp2040.dma.channels[TRANSFER];
    this.begunNs = null;
    this.isRenewing = false;
    this.adc.startADCRead = () => {
      this.begunNs = this.chip.nanos;
      this.done = 0;
      this.input = (this.adc.cs >> 12) & 7;
    };
    for (const peripheral of [this.adc, chip.rp2040.dma]) {
      const read = peripheral.readUint32.bind(peripheral);
      peripheral.readUint32 = (offset) => {
        this.catchUp();
        return read(offset);
      };
      const write = peripheral.writeUint32.bind(peripheral);
      peripheral.writeUint32 = (offset, value) => {
        this.catchUp();
        write(offset, value);
        if ((this.adc.cs & START_MANY) === 0) this.begunNs = null;
      };
    }
  }

  /** The conversions up to now; those that others have overwritten meanwhile are only counted. */
  catchUp() {
    // What starts a transfer anew writes to its registers.
    if (this.begunNs === null || this.isRenewing) return;
    const { adc, transfer } = this;
    const { rp2040 } = this.chip;
    const stepNs = (adc.divider / CLOCK_HZ) * 1e9;
    const due = Math.floor((this.chip.nanos - this.begunNs) / stepNs);
    const kept = due - (transfer.ringMask + 1) / transfer.dataSize;
    const turns = (adc.cs >> 16) & 31;
    while (this.done < due) {
      this.done += 1;
      if (transfer.active) {
        if (this.done > kept) rp2040.writeUint16(transfer.writeAddr, this.code(this.input, this.begunNs + this.done * stepNs));
        const { writeAddr, ringMask, dataSize } = transfer;
        transfer.writeAddr = ((writeAddr & ~ringMask) | ((writeAddr + dataSize) & ringMask)) >>> 0;
        transfer.transCount -= 1;
        if (transfer.transCount === 0) this.renew();
      }
      do this.input = (this.input + 1) % 5;
      while (turns && !(turns & (1 << this.input)));
    }
  }

  /** The end of a transfer starts the one that it is chained to, which takes no time. */
  renew() {
    const { transfer } = this;
    const { channels } = this.chip.rp2040.dma;
    transfer.abort();
    const next = channels[transfer.chainTo];
    next.start();
    next.transferAlarm.cancel();
    this.isRenewing = true;
    next.transfer();
    this.isRenewing = false;
  }
}
