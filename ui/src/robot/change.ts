// SPDX-License-Identifier: Apache-2.0

/** Whatever JSON can say. */
export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type JsonMap = { [key: string]: Json };

/** What turns one map into another, as the server sends it (segue/web/change.hpp). */
export interface Change {
  set?: JsonMap;
  remove?: string[];
  in?: { [key: string]: Change };
}

export function isMap(value: Json | undefined): value is JsonMap {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

/** The map after the change; the parts that stay are shared with the map before, which is not touched. */
export function applyChange(value: Json, change: Change): JsonMap {
  const changed = new Map<string, Json>(isMap(value) ? Object.entries(value) : []);
  for (const key of change.remove ?? []) changed.delete(key);
  for (const [key, inner] of Object.entries(change.in ?? {})) changed.set(key, applyChange(changed.get(key) ?? {}, inner));
  for (const [key, entry] of Object.entries(change.set ?? {})) changed.set(key, entry);
  return Object.fromEntries(changed);
}
