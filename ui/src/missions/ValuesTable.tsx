// SPDX-License-Identifier: Apache-2.0
import { PortName } from '../PortName';
import type { PortValue, Values } from './control';
import type { KnownValues } from './values';

const whens: Record<string, string> = {
  running: 'while it runs', ended: 'it has ended, others beside it run', next: 'as they would be if it began now', '': 'what is around it does not run',
};

const mostLines = 8;
/** Characters of a value in a tip. */
const longest = 70;

function Ports({ label, ports }: { label: string; ports: PortValue[] }) {
  if (ports.length === 0) return null;
  return (
    <table className="values">
      <caption>{label}</caption>
      <thead><tr><th scope="col">name</th><th scope="col">type</th><th scope="col">value</th></tr></thead>
      <tbody>
        {ports.map((port) => (
          <tr key={port.name} data-port={port.name}>
            <th scope="row">{port.name}</th>
            <td className="quiet">{port.type}</td>
            <td><code>{port.text}</code>{port.cut && <span className="quiet"> … cut</span>}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function whenOf(values: Values): string {
  const none = values.inputs.length + values.outputs.length === 0;
  return none && values.when !== '' ? 'no inputs or outputs' : (whens[values.when] ?? values.when);
}

/** The values at the ports of a state; `asks`: what is not known yet has been asked for. */
export function ValuesTable({ known, asks }: { known: KnownValues | null; asks: boolean }) {
  if (!known) return <p className="quiet">{asks ? 'asking the mission …' : 'not known: nobody who may operate has asked for them'}</p>;
  const { values, isCurrent } = known;
  return (
    <div aria-live="polite" data-values={values.of}>
      <p className="quiet">{whenOf(values)}{isCurrent || asks ? '' : '; the mission has gone on since'}</p>
      <Ports label="Inputs" ports={values.inputs} />
      <Ports label="Outputs" ports={values.outputs} />
    </div>
  );
}

const short = (port: PortValue) => (port.text.length > longest ? port.text.slice(0, longest) + '…' : port.text + (port.cut ? '…' : ''));

/** The values of a state in a few lines, for a tip. */
export function ValuesTip({ path, known }: { path: string; known: KnownValues | null }) {
  const values = known?.values;
  const lines = values ? [...values.inputs.map((port) => ['input', port] as const), ...values.outputs.map((port) => ['output', port] as const)] : [];
  return (
    <>
      <strong>{path}</strong>
      <p className="quiet">{values ? whenOf(values) : 'asking the mission …'}</p>
      {lines.slice(0, mostLines).map(([direction, port]) => <div key={direction + port.name}><PortName name={port.name} direction={direction} />: <code>{short(port)}</code></div>)}
      {lines.length > mostLines && <div className="quiet">{lines.length - mostLines} more in its panel</div>}
    </>
  );
}
