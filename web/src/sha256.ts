// SHA-256 (FIPS 180-4). crypto.subtle exists in secure contexts alone, and walks are served over
// plain HTTP too.

const kRounds = new Uint32Array(64);
const kStart = new Uint32Array(8);

// The first 32 bits of the fractional parts of the cube roots (rounds) and square roots (start) of
// the first primes. Doubles hold them exactly enough: 32 bits beside at most 5 before the point.
{
  let found = 0;
  for (let n = 2; found < 64; ++n) {
    let prime = true;
    for (let d = 2; d * d <= n && prime; ++d) prime = n % d !== 0;
    if (!prime) continue;
    const bits = (root: number) => ((root - Math.floor(root)) * 0x100000000) >>> 0;
    kRounds[found] = bits(Math.cbrt(n));
    if (found < 8) kStart[found] = bits(Math.sqrt(n));
    ++found;
  }
}

const rotated = (x: number, by: number) => (x >>> by) | (x << (32 - by));

function addBlock(state: Uint32Array, w: Uint32Array, view: DataView, at: number): void {
  for (let t = 0; t < 16; ++t) w[t] = view.getUint32(at + 4 * t);
  for (let t = 16; t < 64; ++t) {
    const a = w[t - 15];
    const b = w[t - 2];
    w[t] =
      w[t - 16] + (rotated(a, 7) ^ rotated(a, 18) ^ (a >>> 3)) +
      w[t - 7] + (rotated(b, 17) ^ rotated(b, 19) ^ (b >>> 10));
  }
  let [a, b, c, d, e, f, g, h] = state;
  for (let t = 0; t < 64; ++t) {
    const one =
      (h + (rotated(e, 6) ^ rotated(e, 11) ^ rotated(e, 25)) + ((e & f) ^ (~e & g)) + kRounds[t] +
        w[t]) | 0;
    const two =
      ((rotated(a, 2) ^ rotated(a, 13) ^ rotated(a, 22)) + ((a & b) ^ (a & c) ^ (b & c))) | 0;
    h = g;
    g = f;
    f = e;
    e = (d + one) | 0;
    d = c;
    c = b;
    b = a;
    a = (one + two) | 0;
  }
  state[0] += a;
  state[1] += b;
  state[2] += c;
  state[3] += d;
  state[4] += e;
  state[5] += f;
  state[6] += g;
  state[7] += h;
}

/** The digest in lower case hexadecimal digits. */
export function sha256Hex(bytes: Uint8Array): string {
  const state = kStart.slice();
  const w = new Uint32Array(64);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const whole = bytes.length - (bytes.length % 64);
  for (let at = 0; at < whole; at += 64) addBlock(state, w, view, at);
  const left = bytes.length - whole;
  const last = new Uint8Array(left < 56 ? 64 : 128);
  last.set(bytes.subarray(whole));
  last[left] = 0x80;
  const end = new DataView(last.buffer);
  end.setUint32(last.length - 8, Math.floor(bytes.length / 0x20000000));
  end.setUint32(last.length - 4, (bytes.length << 3) >>> 0);
  for (let at = 0; at < last.length; at += 64) addBlock(state, w, end, at);
  return Array.from(state, (n) => n.toString(16).padStart(8, "0")).join("");
}
