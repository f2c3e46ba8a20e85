// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json } from '../robot/change';

/** "cups 3, screws 40", from the document of units; '' where there are none. */
export function unitsText(document: Json | undefined): string {
  const units = isMap(document) ? document['units'] : undefined;
  return Object.entries(isMap(units) ? units : {})
    .flatMap(([name, unit]) => (isMap(unit) ? [name + ' ' + String(unit['count'])] : []))
    .sort()
    .join(', ');
}
