// SPDX-License-Identifier: Apache-2.0
import type { Row, Run } from './run';
import { Panel } from '../panes/Panel';

function secondsText(value: number): string {
  return value.toFixed(value < 10 ? 2 : 1) + ' s';
}

interface Props {
  run: Run;
  row: Row;
  index: number;
  onSelect: (row: number) => void;
}

/** The runs of a node of the chart, and the nodes that it waits for. */
export function NodeFacts({ run, row, index, onSelect }: Props) {
  const waitedBy = run.rows.flatMap((other, at) => (other.waits.some((wait) => wait.row === index) ? [at] : []));
  const bar = row.bars[row.bars.length - 1];
  const line = (at: number, text: string) => (
    <li key={at + text}>
      <button type="button" className="line" disabled={at < 0} onClick={() => onSelect(at)}>
        <span>{run.rows[at]?.label ?? 'nothing in this run'}</span>
        <span className="quiet">{[text, run.rows[at]?.status ?? ''].filter((part) => part !== '').join(', ')}</span>
      </button>
    </li>
  );
  return (
    <>
      <p>
        <strong>{row.status}</strong>
        {row.outcome && ': ' + row.outcome}
        {bar && ', from ' + secondsText(bar.from) + (bar.until === Infinity ? '' : ' to ' + secondsText(bar.until))}
        {row.critical && ', on the critical path ◆'}
        {row.ahead && ', ran ahead of its turn, and its result counts'}
      </p>
      {row.error && <p className="bad">{row.error}</p>}
      <h3>{row.status === 'waiting' ? 'Waits for' : 'Waited for'}</h3>
      {row.waits.length === 0 ? <p className="quiet">nothing that is known</p> : <ul className="plain">{row.waits.map((wait) => line(wait.row, wait.because))}</ul>}
      {waitedBy.length > 0 && (
        <>
          <h3>What waits or waited for it</h3>
          <ul className="plain">{waitedBy.slice(0, 50).map((at) => line(at, ''))}</ul>
        </>
      )}
      {row.bars.length > 1 && <p className="quiet">{row.bars.length} runs, of which {row.bars.filter((one) => one.discarded).length} were thrown away</p>}
    </>
  );
}

/** A node of the chart that is not a state of a plan. */
export function NodePanel(props: Props) {
  return (
    <Panel label={'Node ' + props.row.label}>
      <header>
        <h2>{props.row.label}</h2>
        <button type="button" aria-label="Close" onClick={() => props.onSelect(-1)}>×</button>
      </header>
      <NodeFacts {...props} />
    </Panel>
  );
}
