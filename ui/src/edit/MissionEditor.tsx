// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useRef, useState } from 'react';
import { useConnection } from '../robot/hooks';
import type { ActionEdits } from './ActionForm';
import type { Drafts } from './drafts';
import { addAction, addActionOutcome, addActionPort, addEntry, removeActionOutcome, removeActionPort, setActionPort, setEntry, setFlag } from './mission_actions';
import { addFlow, addOutcome, addPort, addState, described, moveState, removeFlow, removeOutcome, removePort, removeState, renameState, setKind, setPort, setStart, setText, setTransition, setUse, setValue, type NewState } from './mission_edits';
import { meaningOf, missionGraph, openAtFirst, stateNode, stateOfNode, type Shown } from './mission_graph';
import { allLibraries, isContainer, librariesOf, missionIn, newName, stateIn, statesOf, type ActionText, type EditedState, type Interface, type MissionText } from './mission_text';
import { PortGraph } from './PortGraph';
import { StateForm, type StateEdits } from './StateForm';

const reason = (error: unknown) => (error instanceof Error ? error.message : String(error));

/** The missions in other files that this one can use. */
function useLibraries(path: string): Interface[] {
  const connection = useConnection();
  const [libraries, setLibraries] = useState<Interface[]>([]);
  useEffect(() => {
    let current = true;
    connection.call('libraries', { path }).then((answer) => current && setLibraries(librariesOf(answer)), () => undefined);
    return () => {
      current = false;
    };
  }, [connection, path]);
  return libraries;
}

const containerKinds = [
  { kind: 'hierarchy', doc: 'one state at a time' },
  { kind: 'barrier', doc: 'all states at once; its decider says how it ends when all have ended' },
  { kind: 'preemptive', doc: 'all states at once; the first one to end says how it ends' },
];

function Palette({ mission, libraries, into, onAdd }: { mission: MissionText; libraries: Interface[]; into: string; onAdd: (name: string, what: NewState) => void }) {
  const [words, setWords] = useState('');
  const fits = (text: string) => words.toLowerCase().split(/\s+/).every((word) => text.toLowerCase().includes(word));
  const entries = [
    ...mission.actions.map((action) => ({ key: 'action ' + action.name, title: action.name, doc: described(action), name: action.name, what: { action: action.name } as NewState })),
    ...libraries.map((library) => ({ key: 'library ' + library.name, title: 'library ' + library.name, doc: described(library), name: library.name.split('/').pop() ?? library.name, what: { library: library.name } as NewState })),
    ...containerKinds.map(({ kind, doc }) => ({ key: 'container ' + kind, title: 'container: ' + kind, doc, name: kind, what: { kind } as NewState })),
  ].filter((entry) => fits(entry.title + ' ' + entry.doc));
  return (
    <details className="palette">
      <summary>Add a state</summary>
      <p className="quiet">It comes into {into}.</p>
      <input type="search" aria-label="Find actions, libraries and containers" placeholder="Find actions, libraries, containers" value={words} onChange={(event) => setWords(event.target.value)} />
      <ul className="plain">
        {entries.slice(0, 100).map((entry) => (
          <li key={entry.key}>
            <button type="button" className="line documented" onClick={() => onAdd(entry.name, entry.what)}>
              <span>{entry.title}</span>
              <small className="quiet">{entry.doc}</small>
            </button>
          </li>
        ))}
      </ul>
      {entries.length > 100 && <p className="quiet">{entries.length - 100} more; search for them.</p>}
    </details>
  );
}

interface Props {
  path: string;
  text: string;
  drafts: Drafts;
  /** Nothing can be changed. */
  fixed: boolean;
}

/**
 * Changes the text; the problem where that fails, or null. `now`: a state as it is in the text of `before`; `current`:
 * the mission as it is there.
 */
type Edit = (change: (before: string, now: (state: EditedState) => EditedState, current: MissionText) => string) => string | null;

/** The edits of an action. */
function actionEditsOf(name: string, edit: Edit): ActionEdits {
  const change = (one: (text: string, action: ActionText, mission: MissionText) => string) =>
    edit((text, _, current) => {
      const action = current.actions.find((each) => each.name === name);
      if (!action) throw new Error('there is no action ' + name + ' any more');
      return one(text, action, current);
    });
  return {
    setEntry: (path, typed, kind) => change((text, action) => setEntry(text, action, path, typed, kind)),
    addEntry: (key, typed, kind) => change((text, action) => addEntry(text, action, key, typed, kind)),
    setFlag: (flag, on) => void change((text, action) => setFlag(text, action, flag, on)),
    addPort: (side, port, type) => change((text, action) => addActionPort(text, action, side, port, type)),
    setPort: (side, port, type, yaml) => change((text, action) => setActionPort(text, action, side, port, type, yaml)),
    removePort: (side, port) => void change((text, action, current) => removeActionPort(text, current, action, side, port)),
    addOutcome: (outcome) => change((text, action) => addActionOutcome(text, action, outcome)),
    removeOutcome: (outcome) => void change((text, action, current) => removeActionOutcome(text, current, action, outcome)),
  };
}

/** The edits of the state that is selected; each changes the text. */
function editsOf(state: EditedState, mission: MissionText, edit: Edit, onSelect: (id: string | null) => void): StateEdits {
  const inner = (around: EditedState, name: string) => (around.id === '' ? name : around.id + '/' + name);
  const follow = (refused: string | null, id: string | null) => {
    if (refused === null) onSelect(id);
    return refused;
  };
  return {
    rename: (name) => follow(edit((text, now) => renameState(text, mission, now(state), name)), state.parent ? inner(state.parent, name) : ''),
    remove: () => void follow(edit((text, now) => removeState(text, now(state))), null),
    move: (container, before) => void follow(edit((text, now) => moveState(text, now(state), now(container), before)), inner(container, state.name)),
    setTransition: (outcome, target) => void edit((text, now) => setTransition(text, now(state), outcome, target)),
    setStart: (target) => void edit((text, now) => setStart(text, now(state), target)),
    setValue: (side, port, yaml) => edit((text, now) => setValue(text, now(state), side, port, yaml)),
    setText: (key, value) => edit((text, now) => setText(text, now(state), key, value)),
    setKind: (kind) => void edit((text, now) => setKind(text, now(state), kind)),
    setUse: (name) => void edit((text, now) => setUse(text, now(state), name)),
    addOutcome: (name) => edit((text, now) => addOutcome(text, now(state), name)),
    removeOutcome: (name) => void edit((text, now) => removeOutcome(text, now(state), name)),
    addPort: (which, name, type) => edit((text, now) => addPort(text, now(state), which, name, type)),
    removePort: (which, name) => void edit((text, now) => removePort(text, now(state), which, name)),
    setDefault: (which, port, yaml) => edit((text, now) => setPort(text, now(state), which, port, port.type, yaml)),
    connect: (container, from, to) => void edit((text, now) => addFlow(text, now(container), from, to)),
    disconnect: (container, index) => void edit((text, now) => removeFlow(text, now(container), index)),
    addAction: (name) => edit((text, now, current) => addAction(text, current, now(state), name)),
    ofAction: (name) => actionEditsOf(name, edit),
  };
}

/** A mission as a nested graph, beside its text, and the panel of the state that is selected. */
export function MissionEditor({ path, text, drafts, fixed }: Props) {
  const now = useMemo(() => missionIn(text), [text]);
  const lastGood = useRef<MissionText | null>(null);
  if (now) lastGood.current = now;
  const mission = now ?? lastGood.current;
  const files = useLibraries(path);
  const libraries = useMemo(() => (mission ? allLibraries(mission, files) : []), [mission, files]);
  const [machine, setMachine] = useState('');
  const root = (mission?.machines.find((one) => one.name === machine) ?? mission?.machines[0])?.root ?? null;
  const [selected, setSelected] = useState<string | null>(null);
  const [edge, setEdge] = useState<string | null>(null);
  const [shown, setShown] = useState<Shown>('transitions');
  const [open, setOpen] = useState<Set<string> | null>(null);
  const [problem, setProblem] = useState('');
  const shownOpen = useMemo(() => open ?? (root ? openAtFirst(root) : new Set<string>()), [open, root]);
  const graph = useMemo(() => (mission && root ? missionGraph(mission, libraries, root, shownOpen, shown) : null), [mission, libraries, root, shownOpen, shown]);
  if (!mission || !root || !graph) return null;
  const closed = fixed || !now;

  const edit: Edit = (change) => {
    try {
      if (closed) throw new Error('this text cannot be edited in the graph now');
      const before = drafts.get(path)?.state.doc.toString() ?? '';
      const current = (before === text ? mission : missionIn(before)) ?? { ...mission, machines: [] }; // drawing is behind the text
      const nowIn = (state: EditedState) => {
        const found = stateIn(current.machines.find((one) => one.name === machine)?.root ?? root, state.id);
        if (!found) throw new Error('there is no state ' + state.id + ' any more');
        return found;
      };
      drafts.replace(path, change(before, nowIn, current));
      setProblem('');
      return null;
    } catch (error) {
      setProblem(reason(error));
      return reason(error);
    }
  };
  const select = (id: string | null) => {
    setSelected(id);
    setEdge(null);
    const at = stateIn(root, id)?.at;
    if (at !== undefined) drafts.jump(path, at);
  };
  const state = stateIn(root, selected);
  const into = state ? (isContainer(state) ? state : (state.parent ?? root)) : root;
  const addInto = (name: string, what: NewState) => {
    const fresh = newName(into, name);
    if (edit((before, now) => addState(before, now(into), fresh, what)) !== null) return;
    setOpen(new Set([...shownOpen, into.id, ...('kind' in what ? [into.id === '' ? fresh : into.id + '/' + fresh] : [])]));
    setSelected(into.id === '' ? fresh : into.id + '/' + fresh);
  };
  const removeEdge = () => {
    const found = graph.edges.find((one) => one.id === edge);
    if (!found) return;
    const [what, ...rest] = found.id.split(' ');
    const id = stateOfNode(found.source);
    const from = stateIn(root, id);
    if (what === 'on' && from) edit((before, now) => setTransition(before, now(from), found.sourcePort, null));
    const container = what === 'flow' ? stateIn(root, rest.slice(1).join(' ')) : null;
    if (container) edit((before, now) => removeFlow(before, now(container), Number(rest[0])));
    setEdge(null);
  };
  const chosen = edge !== null && !edge.startsWith('start ') ? graph.edges.find((one) => one.id === edge) : undefined;
  return (
    <>
      <div className="half">
        <div className="bar">
          {!closed && <Palette mission={mission} libraries={libraries} into={into.id === '' ? (machine === '' ? 'the mission' : 'the library') : into.id} onAdd={addInto} />}
          {mission.machines.length > 1 && (
            <select aria-label="State machine" value={machine} onChange={(event) => [setMachine(event.target.value), setSelected(null), setEdge(null), setOpen(null)]}>
              {mission.machines.map((one) => <option key={one.name} value={one.name}>{one.name === '' ? 'mission ' + mission.name : 'library ' + one.name}</option>)}
            </select>
          )}
          <label><input type="checkbox" checked={shown === 'flows'} onChange={(event) => [setShown(event.target.checked ? 'flows' : 'transitions'), setEdge(null)]} /> data flows</label>
          <button type="button" className="small" onClick={() => select('')}>{machine === '' ? 'mission' : 'library'} …</button>
          {!now && <span className="badge warn">the text has errors: the graph is as before</span>}
          {chosen && !closed && <button type="button" onClick={removeEdge}>Remove the {shown === 'flows' ? 'data flow' : 'transition'}</button>}
          {problem && <span className="bad" role="alert">{problem}</span>}
        </div>
        <PortGraph
          label="Graph of the mission" groups={graph.groups} nodes={graph.nodes} edges={graph.edges} selected={selected === null ? null : stateNode(selected)} selectedEdge={edge} fixed={closed}
          canConnect={(from, to) => meaningOf(mission, libraries, root, shown, from, to) !== null}
          onSelect={(node) => {
            const id = node === null ? null : stateOfNode(node);
            const closedState = id !== null && !shownOpen.has(id) ? stateIn(root, id) : null;
            if (closedState && isContainer(closedState) && id === selected && id !== null) setOpen(new Set([...shownOpen, id]));
            select(id);
          }}
          onEdge={(id) => [setSelected(null), setEdge(id)]}
          onConnect={(from, to) => {
            const drawn = meaningOf(mission, libraries, root, shown, from, to);
            if (!drawn) return;
            if ('outcome' in drawn) edit((before, now) => setTransition(before, now(drawn.state), drawn.outcome, drawn.target));
            else if ('start' in drawn) edit((before, now) => setStart(before, now(drawn.container), drawn.start));
            else edit((before, now) => addFlow(before, now(drawn.container), drawn.from, drawn.to));
          }}
          onRemove={() => {
            if (edge !== null) return removeEdge();
            if (state?.parent && edit((before, now) => removeState(before, now(state))) === null) setSelected(null);
          }}
        />
      </div>
      {state && (
        <StateForm
          key={machine + ':' + state.id} mission={mission} libraries={libraries} state={state} containers={statesOf(root).filter(isContainer)} fixed={closed}
          edits={editsOf(state, mission, edit, setSelected)} onClose={() => setSelected(null)} isOpen={shownOpen.has(state.id)}
          onToggle={() => {
            const next = new Set(shownOpen);
            if (!next.delete(state.id)) next.add(state.id);
            setOpen(next);
          }}
        />
      )}
    </>
  );
}
