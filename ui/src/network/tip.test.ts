// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { placeOfTip } from './GraphTip';

describe('a tip', () => {
  it('is below its box, above it, or below its title, wherever there is room', () => {
    expect(placeOfTip({ upper: 100, lower: 150 }, 30, 800)).toEqual({ top: 156, maxHeight: 638 });
    expect(placeOfTip({ upper: 700, lower: 750 }, 30, 800)).toEqual({ bottom: 106, maxHeight: 688 });
    expect(placeOfTip({ upper: -50, lower: 900 }, 30, 800)).toEqual({ top: 36, maxHeight: 758 });
  });
});
