// SPDX-License-Identifier: Apache-2.0

const name = 'segue-key';
const inAddress = /^#key=([0-9a-f]+)$/;

/** Keeps the key with which the studio has sent this browser to its page, and takes it out of the address. Other servers of this
    computer, which get the studio's cookie, do not find it: it is kept for this port alone. */
export function keepKey(): void {
  const key = inAddress.exec(window.location.hash)?.[1];
  if (key === undefined) return;
  window.history.replaceState(null, '', '/');
  try {
    window.localStorage.setItem(name, key);
  } catch {
    // The browser keeps nothing: the page cannot come in, and says so.
  }
}

/** The key of the newest page of this studio, in whatever tab. */
export function keptKey(): string | null {
  try {
    return window.localStorage.getItem(name);
  } catch {
    return null;
  }
}

/** The protocols that a WebSocket of the studio offers; none where a certificate is shown instead. */
export function protocolsOf(key: string | null): string[] {
  return key === null ? [] : ['segue.studio', 'key.' + key];
}
