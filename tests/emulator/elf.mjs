// What of an ELF or UF2 file goes into the chip's flash, and where an ELF file's symbols are.

const PT_LOAD = 1;
const UF2_MAGIC = 0x0a324655;
const UF2_BLOCK = 512;

/** Calls `put(address, bytes)` for each piece, by the address at which it is stored. */
export function load(file, put) {
  const view = new DataView(file.buffer, file.byteOffset, file.byteLength);
  if (view.getUint32(0, true) === UF2_MAGIC) {
    for (let at = 0; at < file.length; at += UF2_BLOCK) {
      put(view.getUint32(at + 12, true), file.subarray(at + 32, at + 32 + view.getUint32(at + 16, true)));
    }
    return;
  }
  if (view.getUint32(0) !== 0x7f454c46) throw new Error('not an ELF file');
  const headers = view.getUint32(28, true);
  const size = view.getUint16(42, true);
  const count = view.getUint16(44, true);
  for (let header = headers; header < headers + size * count; header += size) {
    const [type, offset, , physical, length] = [0, 4, 8, 12, 16].map((at) => view.getUint32(header + at, true));
    if (type === PT_LOAD && length > 0) put(physical, file.subarray(offset, offset + length));
  }
}

const SHT_SYMTAB = 2;

/** The value of the first symbol whose name matches. */
export function symbol(file, name) {
  const view = new DataView(file.buffer, file.byteOffset, file.byteLength);
  const sections = view.getUint32(32, true);
  const section = (index) => {
    const at = sections + 40 * index;
    const [type, offset, size, link] = [4, 16, 20, 24].map((field) => view.getUint32(at + field, true));
    return { type, offset, size, link };
  };
  for (let index = 0; index < view.getUint16(48, true); index += 1) {
    const { type, offset, size, link } = section(index);
    if (type !== SHT_SYMTAB) continue;
    const names = section(link).offset;
    for (let at = offset; at < offset + size; at += 16) {
      const start = names + view.getUint32(at, true);
      const text = file.subarray(start, file.indexOf(0, start)).toString('latin1');
      if (name.test(text)) return view.getUint32(at + 4, true);
    }
  }
  throw new Error(`the image has no symbol ${name}`);
}
