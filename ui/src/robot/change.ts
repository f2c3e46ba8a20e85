// SPDX-License-Identifier: Apache-2.0

/** Whatever JSON can say. */
export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type JsonMap = { [key: string]: Json };

/** A change that turns one map into another, as the server sends it (segue/web/change.hpp). */
export interface Change {
  set?: JsonMap;
  remove?: string[];
  in?: { [key: string]: Change };
}

export function isMap(value: Json | undefined): value is JsonMap {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

function put(map: JsonMap, key: string, entry: Json): void {
  if (key === '__proto__') Object.defineProperty(map, key, { value: entry, enumerable: true, configurable: true, writable: true });
  else map[key] = entry;
}

/** The map after the change; the parts that stay are shared with the map before, which is not touched. */
export function applyChange(value: Json, change: Change): JsonMap {
  const changed: JsonMap = isMap(value) ? { ...value } : {};
  for (const key of change.remove ?? []) delete changed[key];
  for (const [key, inner] of Object.entries(change.in ?? {})) put(changed, key, applyChange(changed[key] ?? {}, inner));
  for (const [key, entry] of Object.entries(change.set ?? {})) put(changed, key, entry);
  return changed;
}
