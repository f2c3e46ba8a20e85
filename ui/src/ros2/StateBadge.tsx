// SPDX-License-Identifier: Apache-2.0
import type { Ros2Node } from './ros2';

const tones: Record<string, string> = { active: 'good', inactive: 'idle', unconfigured: 'idle', finalized: 'bad' };

/** The state of a managed node; nothing of others. */
export function StateBadge({ node: { managed, state } }: { node: Pick<Ros2Node, 'managed' | 'state'> }) {
  if (!managed) return null;
  return <span className={'badge tone-' + (state ? (tones[state] ?? 'warn') : 'warn')} title="managed: it has a life cycle">{state || 'state not told'}</span>;
}
