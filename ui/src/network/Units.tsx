// SPDX-License-Identifier: Apache-2.0
import { useMemo } from 'react';
import { useDocument } from '../robot/hooks';
import type { Status } from '../robot/types';
import { holdersOf, unitsText } from './units_text';

/** The units that the robot keeps, as `segue units` has them, and who holds some; nothing where it keeps none. */
export function Units({ status }: { status: Status }) {
  const units = useDocument('units')?.value;
  const keepsSome = unitsText(units, new Map()) !== '';
  const mission = useDocument(keepsSome && status.commanded_by !== null ? 'mission' : null)?.value;
  const holders = useMemo(() => holdersOf(mission), [mission]);
  if (!keepsSome) return null;
  const changed = status.commanded_by ? '; ' + status.commanded_by + ' commands the robot and may change them: what is held is counted until who holds it has ended' : '; `segue units set` corrects them';
  return <span className="quiet" title={'How many units the robot keeps' + changed}>units: {unitsText(units, holders)}</span>;
}
