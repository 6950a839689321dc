/** What went wrong with a walk: where (a file, the browser, the drawing), and why. */
export class WalkError extends Error {
  constructor(
    readonly where: string,
    readonly reason: string,
  ) {
    super(`${where}: ${reason}`);
    this.name = "WalkError";
  }
}

export function asWalkError(error: unknown, where: string): WalkError {
  if (error instanceof WalkError) return error;
  return new WalkError(where, error instanceof Error ? error.message : String(error));
}
