// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, it, vi } from 'vitest';
import { localText, utcText } from './local_time';

afterEach(() => void vi.unstubAllEnvs());

it('times are those of the time zone, of the day', () => {
  const summer = Date.UTC(2026, 6, 1, 23, 30, 5, 250);
  vi.stubEnv('TZ', 'Europe/Berlin');
  expect(localText(summer)).toBe('2026-07-02 01:30:05.250');
  expect(localText(Date.UTC(2026, 0, 1, 12))).toBe('2026-01-01 13:00:00.000');
  expect(utcText(summer)).toBe('2026-07-01 23:30:05.250 UTC');
  expect(localText(NaN)).toBe('');
});
