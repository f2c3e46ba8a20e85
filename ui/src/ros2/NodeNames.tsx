// SPDX-License-Identifier: Apache-2.0
import { addressOf } from '../address';
import { Name } from '../Name';

/** Nodes, each with a link to what is known of it. */
export function NodeNames({ names }: { names: string[] }) {
  const count = (name: string) => names.filter((one) => one === name).length;
  return (
    <ul className="plain">
      {[...new Set(names)].map((name) => (
        <li key={name}>
          {name === '' ? <span className="quiet">not of a node</span> : <a href={addressOf('ros2', name)}><Name text={name} /></a>}
          {count(name) > 1 && <span className="quiet"> ×{count(name)}</span>}
        </li>
      ))}
      {names.length === 0 && <li className="quiet">nobody</li>}
    </ul>
  );
}
