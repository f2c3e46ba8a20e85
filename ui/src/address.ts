// SPDX-License-Identifier: Apache-2.0

/** The part of an address that is for the view itself, such as "drive" of "#events/drive"; '': there is none, or somebody has typed it. */
export function restOfAddress(hash: string, view: string): string {
  if (!hash.startsWith('#' + view + '/')) return '';
  try {
    return decodeURIComponent(hash.slice(view.length + 2));
  } catch {
    return '';
  }
}

export function addressOf(view: string, rest: string): string {
  return '#' + view + '/' + encodeURIComponent(rest);
}
