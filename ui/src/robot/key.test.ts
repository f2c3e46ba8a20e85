// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it, vi } from 'vitest';
import { keepKey, keptKey, protocolsOf } from './key';

/** A browser's window at an address that ends like this. */
function open(hash: string, kept: Map<string, string> = new Map()) {
  const replaced: string[] = [];
  vi.stubGlobal('window', {
    location: { hash },
    history: { replaceState: (_state: null, _title: string, address: string) => replaced.push(address) },
    localStorage: { getItem: (name: string) => kept.get(name) ?? null, setItem: (name: string, value: string) => kept.set(name, value) },
  });
  return replaced;
}

beforeEach(() => vi.unstubAllGlobals());

describe('keepKey', () => {
  it('takes the key out of the address and keeps it', () => {
    const replaced = open('#key=0a1b');
    keepKey();
    expect(replaced).toEqual(['/']);
    expect(keptKey()).toBe('0a1b');
  });
  it('leaves addresses of views as they are', () => {
    for (const hash of ['', '#plots', '#key=', '#key=0a/1b', '#events/key=0a']) {
      const replaced = open(hash);
      keepKey();
      expect(replaced).toEqual([]);
      expect(keptKey()).toBeNull();
    }
  });
});

describe('protocolsOf', () => {
  it('offers a key with the protocol that the studio chooses', () => {
    expect(protocolsOf('0a1b')).toEqual(['segue.studio', 'key.0a1b']);
  });
  it('offers nothing without a key', () => {
    expect(protocolsOf(null)).toEqual([]);
  });
});
