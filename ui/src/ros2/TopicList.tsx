// SPDX-License-Identifier: Apache-2.0
import { Fragment } from 'react';
import { Name } from '../Name';
import { NodeNames } from './NodeNames';
import { mismatchText, withAllWords, type Ros2Seen, type Ros2Topic } from './ros2';

const mostMismatches = 3;

export function Mismatches({ topic }: { topic: Ros2Topic }) {
  const { mismatches } = topic;
  return (
    <>
      {mismatches.slice(0, mostMismatches).map((mismatch, index) => <p key={index} className="warning">{mismatchText(mismatch)}</p>)}
      {mismatches.length > mostMismatches && <p className="warning">{mismatches.length - mostMismatches} more like that</p>}
    </>
  );
}

/** All topics with the nodes on both sides. */
export function TopicList({ seen, words }: { seen: Ros2Seen; words: string }) {
  const found = withAllWords(seen.topics, words, (topic) => [topic.topic, ...topic.types, ...topic.publishers, ...topic.subscriptions]);
  return (
    <div className="scroll" tabIndex={0} role="region" aria-label="Topics">
      <table>
        <thead>
          <tr><th scope="col">Topic</th><th scope="col">Type</th><th scope="col">Published by</th><th scope="col">Subscribed to by</th></tr>
        </thead>
        <tbody>
          {found.map((topic) => (
            <Fragment key={topic.topic}>
              <tr>
                <td><strong><Name text={topic.topic} /></strong></td>
                <td>{topic.types.map((type) => <div key={type}><Name text={type} /></div>)}</td>
                <td><NodeNames names={topic.publishers} /></td>
                <td><NodeNames names={topic.subscriptions} /></td>
              </tr>
              {topic.mismatches.length > 0 && <tr className="below"><td colSpan={4}><Mismatches topic={topic} /></td></tr>}
            </Fragment>
          ))}
        </tbody>
      </table>
      {found.length === 0 && <p className="empty">{seen.topics.length === 0 ? 'These nodes have no topics.' : 'No topic has these words.'}</p>}
    </div>
  );
}
