// SPDX-License-Identifier: Apache-2.0

/** Nothing where the time is not known. */
const textOf = (at: number): string => (Number.isNaN(at) ? '' : new Date(at).toISOString().slice(0, 23).replace('T', ' '));

/** "2026-11-25 17:40:12.345", milliseconds since 1970 in the time zone of the browser. */
export function localText(at: number): string {
  return textOf(at - new Date(at).getTimezoneOffset() * 60000);
}

export const utcText = (at: number): string => textOf(at) + ' UTC';
