// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from 'react';
import { reason } from '../reason';
import { useConnection } from '../robot/hooks';
import type { Drafts } from './drafts';
import { addFlow, addState, described, removeFlow, removeState, setStart, setTransition, type NewState } from './mission_edits';
import { meaningOf, missionGraph, openAtFirst, stateNode, stateOfNode, type Shown } from './mission_graph';
import { allLibraries, isContainer, librariesOf, missionIn, newName, stateIn, statesOf, type EditedState, type Interface, type MissionText } from './mission_text';
import { PortGraph, type End } from './PortGraph';
import { SemanticData } from './SemanticData';
import { editsOf, type CheckedEdit, type Edit, type Edits, type TextChange } from './state_edits';
import { StateForm } from './StateForm';
import { useLastGood } from './useLastGood';


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
  /** Of a machine of RAFCON: the folders of its states, whose semantic data can be changed, by their paths. */
  folders: Record<string, string> | null;
}

/** The id of a state in a container. */
const idIn = (container: EditedState, name: string) => (container.id === '' ? name : container.id + '/' + name);

/** The selection: a state machine, in it a state or an edge of the graph, and the containers that are open. */
function useSelection() {
  const [machine, setMachine] = useState('');
  const [selected, setSelected] = useState<string | null>(null);
  const [edge, setEdge] = useState<string | null>(null);
  const [shown, setShown] = useState<Shown>('transitions');
  const [open, setOpen] = useState<Set<string> | null>(null);
  return {
    machine, selected, edge, shown, open, setSelected, setEdge, setOpen,
    chooseMachine: (name: string) => [setMachine(name), setSelected(null), setEdge(null), setOpen(null)],
    choose: (what: Shown) => [setShown(what), setEdge(null)],
  };
}
type Selection = ReturnType<typeof useSelection>;

/** The selected parts of a mission, found in its text. */
interface Scene {
  mission: MissionText;
  libraries: Interface[];
  root: EditedState;
  open: Set<string>;
  graph: ReturnType<typeof missionGraph>;
}

function useScene(mission: MissionText | null, files: Interface[], { machine, open, shown }: Selection): Scene | null {
  const libraries = useMemo(() => (mission ? allLibraries(mission, files) : []), [mission, files]);
  const root = (mission?.machines.find((one) => one.name === machine) ?? mission?.machines[0])?.root ?? null;
  const shownOpen = useMemo(() => open ?? (root ? openAtFirst(root) : new Set<string>()), [open, root]);
  const graph = useMemo(() => (mission && root ? missionGraph(mission, libraries, root, shownOpen, shown) : null), [mission, libraries, root, shownOpen, shown]);
  return mission && root && graph ? { mission, libraries, root, open: shownOpen, graph } : null;
}

/** Changes the text of the file, which may be ahead of what is drawn. */
function useEdit({ path, text, drafts }: Props, scene: Scene | null, machine: string, closed: boolean): Edits & { problem: string } {
  const [problem, setProblem] = useState('');
  const now = () => drafts.get(path)?.state.doc.toString() ?? '';
  const changed = (before: string, change: TextChange): string => {
    if (closed || !scene) throw new Error('this text cannot be edited in the graph now');
    const current = (before === text ? scene.mission : missionIn(before)) ?? { ...scene.mission, machines: [] };
    const nowIn = (state: EditedState) => {
      const found = stateIn(current.machines.find((one) => one.name === machine)?.root ?? scene.root, state.id);
      if (!found) throw new Error('there is no state ' + state.id + ' any more');
      return found;
    };
    return change(before, nowIn, current);
  };
  const edit: Edit = (change) => {
    try {
      drafts.replace(path, changed(now(), change));
      setProblem('');
      return null;
    } catch (error) {
      setProblem(reason(error));
      return reason(error);
    }
  };
  const checked: CheckedEdit = async (change) => {
    try {
      for (;;) {
        const before = now();
        const refused = await drafts.newError(path, before, changed(before, change));
        if (now() !== before) continue; // somebody has typed meanwhile
        return refused ?? edit(change);
      }
    } catch (error) {
      return reason(error);
    }
  };
  return { edit, checked, problem };
}

/** The actions of the bar and of the graph. */
function verbsOf({ path, drafts }: Props, { mission, libraries, root, open, graph }: Scene, selection: Selection, edit: Edit) {
  const { selected, edge, shown, setSelected, setEdge, setOpen } = selection;
  const state = stateIn(root, selected);
  const into = state ? (isContainer(state) ? state : (state.parent ?? root)) : root;
  const select = (id: string | null) => {
    setSelected(id);
    setEdge(null);
    const at = stateIn(root, id)?.at;
    if (at !== undefined) drafts.jump(path, at);
  };
  const add = (name: string, what: NewState) => {
    const fresh = newName(into, name);
    if (edit((before, now) => addState(before, now(into), fresh, what)) !== null) return;
    setOpen(new Set([...open, into.id, ...('kind' in what ? [idIn(into, fresh)] : [])]));
    setSelected(idIn(into, fresh));
  };
  const connect = (from: End, to: End) => {
    const drawn = meaningOf(mission, libraries, root, shown, from, to);
    if (!drawn) return;
    if ('outcome' in drawn) edit((before, now) => setTransition(before, now(drawn.state), drawn.outcome, drawn.target));
    else if ('start' in drawn) edit((before, now) => setStart(before, now(drawn.container), drawn.start));
    else edit((before, now) => addFlow(before, now(drawn.container), drawn.from, drawn.to));
  };
  const removeEdge = () => {
    const found = graph.edges.find((one) => one.id === edge);
    if (!found) return;
    const [what, ...rest] = found.id.split(' ');
    const from = stateIn(root, stateOfNode(found.source));
    if (what === 'on' && from) edit((before, now) => setTransition(before, now(from), found.sourcePort, null));
    const container = what === 'flow' ? stateIn(root, rest.slice(1).join(' ')) : null;
    if (container) edit((before, now) => removeFlow(before, now(container), Number(rest[0])));
    setEdge(null);
  };
  const remove = () => {
    if (edge !== null) return removeEdge();
    if (state?.parent && edit((before, now) => removeState(before, now(state))) === null) setSelected(null);
  };
  return { state, into, select, add, connect, removeEdge, remove };
}

interface PartProps {
  scene: Scene;
  selection: Selection;
  verbs: ReturnType<typeof verbsOf>;
  closed: boolean;
}

function Bar({ scene: { mission, libraries, graph }, selection, verbs, closed, hasErrors, problem }: PartProps & { hasErrors: boolean; problem: string }) {
  const { machine, edge, shown, chooseMachine, choose } = selection;
  const { into, select, add, removeEdge } = verbs;
  const chosen = edge !== null && !edge.startsWith('start ') ? graph.edges.find((one) => one.id === edge) : undefined;
  return (
    <div className="bar">
      {!closed && <Palette mission={mission} libraries={libraries} into={into.id === '' ? (machine === '' ? 'the mission' : 'the library') : into.id} onAdd={add} />}
      {mission.machines.length > 1 && (
        <select aria-label="State machine" value={machine} onChange={(event) => chooseMachine(event.target.value)}>
          {mission.machines.map((one) => <option key={one.name} value={one.name}>{one.name === '' ? 'mission ' + mission.name : 'library ' + one.name}</option>)}
        </select>
      )}
      <label><input type="checkbox" checked={shown === 'flows'} onChange={(event) => choose(event.target.checked ? 'flows' : 'transitions')} /> data flows</label>
      <button type="button" className="small" onClick={() => select('')}>{machine === '' ? 'mission' : 'library'} …</button>
      {hasErrors && <span className="badge warn">the text has errors: the graph is as before</span>}
      {chosen && !closed && <button type="button" onClick={removeEdge}>Remove the {shown === 'flows' ? 'data flow' : 'transition'}</button>}
      {problem && <span className="bad" role="alert">{problem}</span>}
    </div>
  );
}

function StateGraph({ scene: { mission, libraries, root, open, graph }, selection, verbs, closed }: PartProps) {
  const { selected, edge, shown, setSelected, setEdge, setOpen } = selection;
  /** A closed container that is selected already is opened. */
  const pick = (node: string | null) => {
    const id = node === null ? null : stateOfNode(node);
    const state = id !== null && !open.has(id) ? stateIn(root, id) : null;
    if (state && isContainer(state) && id === selected && id !== null) setOpen(new Set([...open, id]));
    verbs.select(id);
  };
  return (
    <PortGraph
      label="Graph of the mission" groups={graph.groups} nodes={graph.nodes} edges={graph.edges} selected={selected === null ? null : stateNode(selected)} selectedEdge={edge} fixed={closed}
      canConnect={(from, to) => meaningOf(mission, libraries, root, shown, from, to) !== null}
      onSelect={pick} onEdge={(id) => [setSelected(null), setEdge(id)]} onConnect={verbs.connect} onRemove={verbs.remove}
    />
  );
}

/** A mission as a nested graph, beside its text, and the panel of the state that is selected. */
export function MissionEditor(props: Props) {
  const now = useMemo(() => missionIn(props.text), [props.text]);
  const mission = useLastGood<MissionText>(now);
  const libraries = useLibraries(props.path);
  const selection = useSelection();
  const scene = useScene(mission, libraries, selection);
  const closed = props.fixed || !now;
  const { problem, ...edits } = useEdit(props, scene, selection.machine, closed);
  if (!scene) return null;
  return <Editor props={props} scene={scene} selection={selection} closed={closed} hasErrors={!now} edits={edits} problem={problem} />;
}

/** Of a state of RAFCON; those in libraries are edited in the machine that the library is. */
function SemanticPart({ props: { path, drafts, folders }, machine, state }: { props: Props; machine: string; state: EditedState }) {
  const mayChange = useConnection().mayOperate;
  const folder = machine === '' ? folders?.[state.id] : undefined;
  if (!folders) return null;
  if (folder === undefined) return <p className="quiet">Its semantic data belong to the library {machine}; they are edited in its own machine.</p>;
  return <SemanticData key={folder} path={path} state={folder} fixed={!mayChange} onSaved={() => void drafts.readAgain(path, false)} />;
}

function Editor({ props, scene, selection, closed, hasErrors, edits, problem }: Omit<PartProps, 'verbs'> & { props: Props; hasErrors: boolean; edits: Edits; problem: string }) {
  const { mission, libraries, root, open } = scene;
  const { machine, setSelected, setOpen } = selection;
  const verbs = verbsOf(props, scene, selection, edits.edit);
  const { state } = verbs;
  const toggle = (id: string) => {
    const next = new Set(open);
    if (!next.delete(id)) next.add(id);
    setOpen(next);
  };
  return (
    <>
      <div className="half">
        <Bar scene={scene} selection={selection} verbs={verbs} closed={closed} hasErrors={hasErrors} problem={problem} />
        <StateGraph scene={scene} selection={selection} verbs={verbs} closed={closed} />
      </div>
      {state && (
        <StateForm
          key={machine + ':' + state.id} mission={mission} libraries={libraries} state={state} containers={statesOf(root).filter(isContainer)} fixed={closed}
          edits={editsOf(state, mission, edits, setSelected)} onClose={() => setSelected(null)} isOpen={open.has(state.id)} onToggle={() => toggle(state.id)}
        >
          <SemanticPart props={props} machine={machine} state={state} />
        </StateForm>
      )}
    </>
  );
}
