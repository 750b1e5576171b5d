// What of an ELF file goes into the chip's flash.

const PT_LOAD = 1;

/** Calls `put(address, bytes)` for each piece, by the address at which it is stored. */
export function load(file, put) {
  const view = new DataView(file.buffer, file.byteOffset, file.byteLength);
  if (view.getUint32(0) !== 0x7f454c46) throw new Error('not an ELF file');
  const headers = view.getUint32(28, true);
  const size = view.getUint16(42, true);
  const count = view.getUint16(44, true);
  for (let header = headers; header < headers + size * count; header += size) {
    const [type, offset, , physical, length] = [0, 4, 8, 12, 16].map((at) => view.getUint32(header + at, true));
    if (type === PT_LOAD && length > 0) put(physical, file.subarray(offset, offset + length));
  }
}
