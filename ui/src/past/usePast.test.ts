// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import type { PastRequest } from './film';
import { withFirst, type Page } from './usePast';

/** The requests from `newest` down to `oldest`. */
const requests = (newest: number, oldest: number) => Array.from({ length: newest - oldest + 1 }, (_, index) => ({ id: newest - index }) as PastRequest);
const idsOf = ({ requests: all }: Page) => [all[0]?.id, all[all.length - 1]?.id, all.length];

test('the list of requests does not grow by those that come', () => {
  let shown = withFirst({ requests: requests(30, 1), more: false }, null);
  expect(idsOf(shown)).toEqual([30, 1, 30]);
  for (let newest = 31; newest <= 500; ++newest) shown = withFirst({ requests: requests(newest, Math.max(1, newest - 49)), more: newest > 50 }, shown);
  expect(idsOf(shown)).toEqual([500, 451, 50]);
  expect(shown.more).toBe(true);
});

test('pages that were asked for stay', () => {
  const both = { requests: requests(500, 401), more: false };
  const shown = withFirst({ requests: requests(501, 452), more: true }, both);
  expect(idsOf(shown)).toEqual([501, 402, 100]);
  expect(shown.more).toBe(true);
  const same = withFirst({ requests: requests(500, 451), more: true }, both);
  expect(idsOf(same)).toEqual([500, 401, 100]);
  expect(same.more).toBe(false);
});
