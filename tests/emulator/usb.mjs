// The host's end of the USB cable: enumerates the board and carries bytes, at the speed of a full-speed bus.
//
// rp2040js completes transfers at once and forgets which buffers wait for data, and a suspension that was taken note of never ends. Here
// a buffer stays with the bus until its packet is through, and writing the suspension's bit clears it.

const AVAILABLE = 1 << 10;
const FULL = 1 << 15;
const LENGTH = 0x3ff;
const IN_CONTROL = 0x80;
const OUT_CONTROL = 0x84;
const LAST_CONTROL = 0xfc;
const SIE_STATUS = 0x50;
const SUSPENDED = 1 << 4;

// 64 bytes with their token, handshake and a share of the frame's beginning: 18 packets a millisecond.
const PACKET_NS = 55_000;
const PLUG_NS = 1_000_000;

export class UsbHost {
  /** `heard(bytes)`: what the board said. `identified(identity)`: what its descriptors say. */
  constructor(chip, heard, identified) {
    this.chip = chip;
    this.usb = chip.rp2040.usbCtrl;
    this.heard = heard;
    this.identified = identified;
    this.plugged = false;
    this.configured = false;
    this.queue = [];
    this.armedIn = false;
    this.armedOut = false;
    this.inAlarm = chip.clock.createAlarm(() => this.finishIn());
    this.outAlarm = chip.clock.createAlarm(() => this.finishOut());
    this.plugAlarm = chip.clock.createAlarm(() => this.plugged && this.usb.resetDevice());
    this.usb.onUSBEnabled = () => this.plugged && this.usb.resetDevice();
    this.usb.onResetReceived = () => this.enumerate();
    this.usb.onEndpointWrite = (endpoint, data) => endpoint === 0 && this.control(data);
    this.usb.onEndpointRead = () => {};
    const write = this.usb.writeUint32.bind(this.usb);
    this.usb.writeUint32 = (offset, value) => {
      if (offset === SIE_STATUS) this.usb.sieStatus &= ~(this.usb.rawWriteValue & SUSPENDED);
      write(offset, value);
    };
    const updated = this.usb.DPRAMUpdated.bind(this.usb);
    this.usb.DPRAMUpdated = (offset, value) => this.updated(offset, value) || updated(offset, value);
  }

  plug() {
    this.plugged = true;
    if (this.usb.mainCtrl & 1) this.plugAlarm.schedule(PLUG_NS);
  }

  pull() {
    this.plugged = false;
    this.configured = false;
    this.queue = [];
    this.inAlarm.cancel();
    this.outAlarm.cancel();
    // Three milliseconds without a frame: suspended.
    this.usb.sieStatus |= SUSPENDED;
    this.usb.sieStatusUpdated();
  }

  /** Bytes for the board. */
  say(bytes) {
    if (!this.plugged) return;
    for (let at = 0; at < bytes.length; at += 64) this.queue.push(bytes.subarray(at, at + 64));
    this.offer();
  }

  // Address, configuration descriptor (its head, then all of it), configuration, line state.
  enumerate() {
    this.configured = false;
    this.armedIn = this.armedOut = false;
    this.descriptor = [];
    this.wanted = 0;
    this.steps = [
      [0x00, 0x05, 1, 0, 0, 0, 0, 0],
      [0x80, 0x06, 0, 2, 0, 0, 9, 0],
    ];
    this.next();
  }

  next() {
    const step = this.steps.shift();
    if (step) this.usb.sendSetupPacket(Uint8Array.from(step));
    else if (!this.configured) {
      this.configured = true;
      this.offer();
    }
  }

  control(data) {
    if (data.length === 0) return this.next();
    this.descriptor.push(...data);
    if (this.wanted === 0 && this.descriptor.length === 9) {
      this.wanted = this.descriptor[2] | (this.descriptor[3] << 8);
      this.descriptor = [];
      this.steps.push([0x80, 0x06, 0, 2, 0, 0, this.wanted & 255, this.wanted >> 8]);
      this.next();
    } else if (this.descriptor.length === this.wanted) {
      this.findEndpoints();
      this.steps.push([0x00, 0x09, 1, 0, 0, 0, 0, 0], [0x21, 0x22, 3, 0, 0, 0, 0, 0]);
      this.next();
    }
  }

  /** The bulk endpoints, one each way. */
  findEndpoints() {
    for (let at = 0; at < this.descriptor.length; at += this.descriptor[at]) {
      const [, type, address, attributes] = this.descriptor.slice(at, at + 4);
      if (type !== 5 || (attributes & 3) !== 2) continue;
      if (address & 0x80) this.in = address & 15;
      else this.out = address & 15;
    }
  }

  /** A buffer is handed to the bus; returns whether it is one of ours. */
  updated(offset, value) {
    if (!(value & AVAILABLE) || offset < IN_CONTROL || offset > LAST_CONTROL) return false;
    const endpoint = (offset - IN_CONTROL) >> 3;
    const isOut = (offset & 4) !== 0;
    if (isOut && endpoint === this.out) {
      this.armedOut = true;
      this.offer();
      return true;
    }
    if (!isOut && endpoint === this.in) {
      this.armedIn = true;
      if (this.plugged) this.inAlarm.schedule(PACKET_NS);
      return true;
    }
    return false;
  }

  finishIn() {
    if (!this.plugged || !this.armedIn) return;
    this.armedIn = false;
    const view = this.chip.rp2040.usbDPRAMView;
    const offset = IN_CONTROL + this.in * 8;
    const value = view.getUint32(offset, true);
    const buffer = this.usb.getEndpointBufferOffset(this.in, false);
    const data = this.chip.rp2040.usbDPRAM.slice(buffer, buffer + (value & LENGTH));
    view.setUint32(offset, value & ~(AVAILABLE | FULL), true);
    this.usb.indicateBufferReady(this.in, false);
    if (data.length > 0) this.heard(data);
  }

  offer() {
    const isBusy = this.outAlarm.scheduled;
    if (this.configured && this.plugged && this.armedOut && this.queue.length > 0 && !isBusy) {
      this.outAlarm.schedule(PACKET_NS);
    }
  }

  finishOut() {
    this.outAlarm.scheduled = false;
    if (!this.plugged || !this.armedOut || this.queue.length === 0) return;
    this.armedOut = false;
    const view = this.chip.rp2040.usbDPRAMView;
    const offset = OUT_CONTROL + this.out * 8;
    view.setUint32(offset, view.getUint32(offset, true) & ~AVAILABLE, true);
    this.usb.finishRead(this.out, this.queue.shift());
    this.offer();
  }
}
