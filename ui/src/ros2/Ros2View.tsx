// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from 'react';
import { ActionButton } from '../ActionButton';
import { addressOf, restOfAddress } from '../address';
import { LocalTime } from '../LocalTime';
import { Name } from '../Name';
import { ListPane } from '../panes/Panel';
import type { Status } from '../robot/types';
import { NodeDetails } from './NodeDetails';
import { groupsOf, placeText, tasksOf, taskBehind, withAllWords, type Ros2Node, type Ros2Seen } from './ros2';
import './ros2.css';
import { StateBadge } from './StateBadge';
import { TopicList } from './TopicList';
import { useRos2, type Ros2State } from './useRos2';

const wanted = () => restOfAddress(window.location.hash, 'ros2');

/** The node that the address names; '': none. */
function useChosen(): string {
  const [chosen, setChosen] = useState(wanted);
  useEffect(() => {
    const follow = () => setChosen(wanted());
    window.addEventListener('hashchange', follow);
    return () => window.removeEventListener('hashchange', follow);
  }, []);
  return chosen;
}

/** Escape goes from a node back to the topics. */
function useEscape() {
  useEffect(() => {
    const close = (event: KeyboardEvent) => {
      if (event.key === 'Escape' && wanted() !== '') window.location.hash = 'ros2';
    };
    window.addEventListener('keydown', close);
    return () => window.removeEventListener('keydown', close);
  }, []);
}

const counted = (count: number, what: string) => `${count} ${what}${count === 1 ? '' : 's'}`;

function Places({ seen, isLooking, onPlace }: { seen: Ros2Seen; isLooking: boolean; onPlace: (index: number) => void }) {
  if (seen.places.length < 2) return null;
  const chosen = seen.places.findIndex(({ domain, discovery }) => domain === seen.place.domain && discovery === seen.place.discovery);
  return (
    <label>
      look at{' '}
      <select value={chosen} disabled={isLooking} onChange={(event) => onPlace(Number(event.target.value))}>
        {seen.places.map((place, index) => <option key={index} value={index}>{placeText(place)}</option>)}
      </select>
    </label>
  );
}

function LookBar({ state, look }: { state: Ros2State; look: ReturnType<typeof useRos2>['look'] }) {
  const { seen, at, isLooking, problem } = state;
  return (
    <div className="bar">
      <ActionButton type="button" whyNot={isLooking ? 'listening for nodes, which takes some seconds …' : ''} title="Nodes are listened for, then each is asked for its parameters and state" onClick={() => look()}>
        Look again
      </ActionButton>
      {seen && <Places seen={seen} isLooking={isLooking} onPlace={(index) => look(seen.places[index])} />}
      {seen && (
        <span className="quiet">
          domain {seen.domain}{seen.place.discovery !== '' && ', ' + seen.place.discovery}: {counted(seen.nodes.length, 'node')}, {counted(seen.topics.length, 'topic')}, as of <LocalTime at={at} from={11} to={19} />
        </span>
      )}
      {problem !== '' && <span className="bad" role="alert">The look failed: {problem}{seen && '. What is shown is of the one before.'}</span>}
    </div>
  );
}

/** While there is nothing to show. */
function NoNodes({ seen, problem }: { seen: Ros2Seen | null; problem: string }) {
  return (
    <p className="empty">
      The nodes of ROS 2 are shown here, with their topics, services, actions and parameters, as <code>segue ros2 describe</code> shows them.{' '}
      {seen ? (
        <>
          No node was found in domain {seen.domain}. Is the domain the right one? It is that of the robot&apos;s tasks of ROS 2 (their property <code>domain</code>), or where there are none{' '}
          <code>$ROS_DOMAIN_ID</code> of the studio; and with <code>discovery: localhost</code> or <code>$ROS_LOCALHOST_ONLY</code> it ends at this computer.
        </>
      ) : problem === '' ? (
        <>They tell of themselves: nodes are listened for some seconds.</>
      ) : (
        <>The look is made on the computer where the studio runs, by the program of the package <code>segue-ros2</code>.</>
      )}
    </p>
  );
}

interface LineProps {
  node: Ros2Node;
  seen: Ros2Seen;
  status: Status;
  chosen: boolean;
}

function NodeLine({ node, seen, status, chosen }: LineProps) {
  const own = taskBehind(node, seen, status);
  const tasks = own ? [own] : tasksOf(node, seen, status);
  return (
    <li>
      <a className="line" href={addressOf('ros2', node.name)} aria-current={chosen ? 'true' : undefined}>
        <span><Name text={node.name} /></span>
        <StateBadge node={node} />
        {tasks.length > 0 && <span className="quiet of-task">{own ? 'is ' : ''}task {tasks.join(', ')}</span>}
      </a>
    </li>
  );
}

interface ListProps {
  seen: Ros2Seen;
  status: Status;
  chosen: string;
  words: string;
  onWords: (words: string) => void;
}

function NodeList({ seen, status, chosen, words, onWords }: ListProps) {
  const found = withAllWords(seen.nodes, words, (node) => [node.name, node.state ?? '', node.process?.package ?? '', ...tasksOf(node, seen, status)]);
  return (
    <ListPane label="Nodes of ROS 2">
      <label className="search">
        <span className="hidden">Find nodes and topics</span>
        <input type="search" placeholder="Find nodes, topics ( / )" data-search value={words} onChange={(event) => onWords(event.target.value)} />
      </label>
      <ul className="plain">
        <li><a className="line" href="#ros2" aria-current={chosen === '' ? 'true' : undefined}>All topics</a></li>
      </ul>
      {groupsOf(found, seen, status).map(({ title, nodes }) => (
        <div key={title}>
          <h2>{title}</h2>
          <ul className="plain">
            {nodes.map((node) => <NodeLine key={node.name} node={node} seen={seen} status={status} chosen={node.name === chosen} />)}
          </ul>
        </div>
      ))}
      {found.length === 0 && <p className="quiet">No node has these words.</p>}
    </ListPane>
  );
}

function Content({ seen, status, chosen, words }: Omit<ListProps, 'onWords'>) {
  const node = seen.nodes.find(({ name }) => name === chosen);
  if (chosen === '') return <TopicList seen={seen} words={words} />;
  if (node) return <NodeDetails key={node.name} node={node} seen={seen} status={status} />;
  return (
    <p className="empty">
      The last look has not found the node {chosen}: it does not run, is in another domain than {seen.domain}, or had too little time to tell of itself. <em>Look again</em> may find it.
    </p>
  );
}

/** The nodes and topics of ROS 2 beside the robot, as the last look has found them. */
export function Ros2View({ status }: { status: Status }) {
  const { look, ...state } = useRos2();
  const chosen = useChosen();
  const [words, setWords] = useState('');
  useEscape();
  const { seen, problem } = state;
  const shown = seen !== null && seen.nodes.length + seen.topics.length > 0 ? seen : null;
  return (
    <div className="view switch ros2">
      {shown && <NodeList seen={shown} status={status} chosen={chosen} words={words} onWords={setWords} />}
      <section className="main" aria-label="ROS 2" aria-busy={state.isLooking}>
        <LookBar state={state} look={look} />
        {shown ? <Content seen={shown} status={status} chosen={chosen} words={words} /> : <NoNodes seen={seen} problem={problem} />}
      </section>
    </div>
  );
}
