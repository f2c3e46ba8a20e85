// SPDX-License-Identifier: Apache-2.0
import { localText, utcText } from './local_time';

/** A time (milliseconds since 1970) as clocks beside the browser show it, with that of UTC at the pointer; `from`, `to`: a part of the text. */
export function LocalTime({ at, from = 0, to = 23 }: { at: number; from?: number; to?: number }) {
  return <time dateTime={Number.isNaN(at) ? undefined : new Date(at).toISOString()} title={utcText(at)}>{localText(at).slice(from, to)}</time>;
}
