// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { toneOfOutcome } from './outcome';

it('shows what was requested and runs as good, and what nobody knows as bad', () => {
  expect(['done', 'superseded', 'refused', 'failed', 'cancelled', 'unheard of'].map(toneOfOutcome)).toEqual(['good', 'idle', 'bad', 'bad', 'bad', 'bad']);
});
