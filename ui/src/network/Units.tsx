// SPDX-License-Identifier: Apache-2.0
import { useDocument } from '../robot/hooks';
import type { Status } from '../robot/types';
import { unitsText } from './units_text';

/** The units that the robot keeps, as `segue units` has them; nothing where it keeps none. */
export function Units({ status }: { status: Status }) {
  const text = unitsText(useDocument('units')?.value);
  if (text === '') return null;
  const changed = status.commanded_by ? '; ' + status.commanded_by + ' commands the robot and may change them' : '; `segue units set` corrects them';
  return <span className="quiet" title={'How many units the robot keeps' + changed}>units: {text}</span>;
}
