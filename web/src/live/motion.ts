// How fast an eye moves and turns, from where it was seen: means over a tenth of a second, so that one late frame
// is no leap.

/** Metres a frame that nobody walks: a leap has no speed. */
const kLeap = 0.5;
/** Seconds: the shortest time that a speed is measured over, the longest, and that of the mean. */
const kShortest = 1 / 250, kLongest = 0.5, kMean = 0.1;

export class Motion {
  /** A second. */
  readonly velocity = new Float64Array(3);
  /** Radians a second about this axis of the world. */
  readonly turnRate = new Float64Array(3);
  /** Metres of a unit of length. */
  unit = 1;
  private readonly before = new Float64Array(16);
  private began = false;

  /** The eye is at `e` now, world from eye, column by column, `passed` seconds after the last call. */
  see(e: ArrayLike<number>, passed: number): void {
    const { before, velocity, turnRate, began } = this;
    if (began) {
      const seconds = Math.max(kShortest, passed), share = Math.min(1, seconds / kMean);
      const way = [0, 1, 2].map((k) => e[12 + k] - before[12 + k]);
      const leap = this.unit * Math.hypot(...way) > kLeap || seconds > kLongest;
      for (let k = 0; k < 3; ++k) {
        const i = (k + 1) % 3, j = (k + 2) % 3;
        // Of a small turn the axis times the angle is half the sum of the axes' cross products.
        let turn = 0;
        for (let a = 0; a < 12; a += 4) turn += 0.5 * (before[a + i] * e[a + j] - before[a + j] * e[a + i]);
        velocity[k] = leap ? 0 : velocity[k] + share * (way[k] / seconds - velocity[k]);
        turnRate[k] = leap ? 0 : turnRate[k] + share * (turn / seconds - turnRate[k]);
      }
    }
    for (let k = 0; k < 16; ++k) before[k] = e[k];
    this.began = true;
  }

  stop(): void {
    this.velocity.fill(0);
    this.turnRate.fill(0);
  }
}
