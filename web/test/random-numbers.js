/** Numbers from 0 to 1, the same ones for the same seed. */
export function randomNumbers(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** Numbers from `low` to `high`, likewise. */
export function numbersBetween(seed) {
  const random = randomNumbers(seed);
  return (low, high) => low + (high - low) * random();
}
