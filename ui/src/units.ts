// SPDX-License-Identifier: Apache-2.0

/** "1.25 µs", "3.2 ms", "12 s": three digits, as the command line has them. */
export function durationText(seconds: number): string {
  const digits = (value: number) => String(Number(value.toPrecision(3)));
  if (seconds >= 0.9995) return digits(seconds) + ' s';
  if (seconds >= 0.9995e-3) return digits(seconds * 1e3) + ' ms';
  return digits(seconds * 1e6) + ' µs';
}

export const microsecondsText = (microseconds: number) => durationText(microseconds / 1e6);
