// A link that damages what passes through it.

/**
 * `rate`: how likely each byte is flipped in a bit, dropped, doubled, or held back behind its successor, all alike; `isBad()`: whether
 * it is at the time.
 */
export function damage(rate = 0, seed = 1, isBad = () => true) {
  let random = seed >>> 0 || 1;
  const next = () => {
    random ^= random << 13;
    random ^= random >>> 17;
    random ^= random << 5;
    return (random >>> 0) / 2 ** 32;
  };
  const counts = { bytes: 0, flipped: 0, dropped: 0, doubled: 0, delayed: 0 };
  let held = null;
  const pass = (bytes) => {
    if (rate === 0 || !isBad()) return bytes;
    counts.bytes += bytes.length;
    const out = [];
    for (const byte of bytes) {
      const kind = next() < rate ? Math.floor(next() * 4) : -1;
      if (kind === 3 && held === null) {
        held = byte;
        counts.delayed += 1;
        continue;
      }
      if (kind === 0) {
        out.push(byte ^ (1 << Math.floor(next() * 8)));
        counts.flipped += 1;
      } else if (kind === 1) counts.dropped += 1;
      else if (kind === 2) {
        out.push(byte, byte);
        counts.doubled += 1;
      } else out.push(byte);
      if (held !== null) out.push(held);
      held = null;
    }
    return Uint8Array.from(out);
  };
  return { pass, counts };
}
