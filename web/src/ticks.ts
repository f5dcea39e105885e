// The tick labels of a plot's axis.

/** The number of digits from which ticks are written as differences from the first. */
const MANY_DIGITS = 6;

/** Formats ascending, equidistant ticks, each as short as possible and different from its neighbours. */
export function tickTexts(ticks: number[]): string[] {
  const step = ticks.length > 1 ? (ticks[ticks.length - 1] - ticks[0]) / (ticks.length - 1) : 0;
  const max = Math.max(...ticks.map(Math.abs));
  if (!(step > 0)) return ticks.map((value) => short(value, max / 1e3));
  if (max / step < 10 ** (MANY_DIGITS - 1)) return ticks.map((value) => short(value, step));
  const rest = ticks.map((value) => `+${short(value - ticks[0], step)}`);
  return [short(ticks[0], step), ...rest.slice(1)];
}

/** Formats a number with the digits that distinguish it at this distance: some ticks are 2.5 units apart. */
function short(value: number, distance: number): string {
  if (Math.abs(value) <= 1e-3 * distance) return "0";
  const last = Math.floor(Math.log10(distance)) - 1;
  const first = Math.floor(Math.log10(Math.abs(value)));
  const rounded = Number(value.toPrecision(Math.min(17, Math.max(1, first - last + 1))));
  return first < -3 || first > 5 ? rounded.toExponential() : `${rounded}`;
}
