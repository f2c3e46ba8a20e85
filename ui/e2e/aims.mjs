// SPDX-License-Identifier: Apache-2.0
// Aims of programs that measure: what is measured is printed with its aim, and a missed one makes the program fail at its end.

/** Prints a figure; `aim` is its least value ({ least }) or its greatest ({ most }). */
export function figure(name, value, unit, aim = {}) {
  const digits = unit === 'ms' ? 0 : 1;
  const missed = value < (aim.least ?? -Infinity) || value > (aim.most ?? Infinity);
  const wanted = aim.least !== undefined ? `, at least ${aim.least} wanted` : aim.most !== undefined ? `, at most ${aim.most} wanted` : '';
  console.log(`${missed ? 'MISSED ' : ''}${name}: ${value.toFixed(digits)} ${unit}${wanted}`);
  if (missed) process.exitCode = 1;
}

/** Frames a second, of the times between frames in ms. */
export function frames(name, intervals, least) {
  const sorted = [...intervals].sort((a, b) => a - b);
  const sum = intervals.reduce((total, one) => total + one, 0);
  figure(name, (1000 * intervals.length) / sum, 'frames/s', { least });
  console.log(`  95 % within ${sorted[Math.floor(sorted.length * 0.95)].toFixed(1)} ms, longest ${sorted[sorted.length - 1].toFixed(1)} ms`);
}
