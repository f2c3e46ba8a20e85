// SPDX-License-Identifier: Apache-2.0
import type { ActionEdits } from './ActionForm';
import type { Refusal } from './Fields';
import { addAction, addActionOutcome, addActionPort, addEntry, pathOf, removeActionOutcome, removeActionPort, setActionPort, setDeclared, setEntry, setFlag } from './mission_actions';
import { addFlow, addOutcome, addPort, moveState, removeFlow, removeOutcome, removePort, removeState, renameState, setKind, setPort, setStart, setText, setTransition, setUse, setValue } from './mission_edits';
import { type ActionText, type EditedState, type MissionText } from './mission_text';
import type { StateEdits } from './StateForm';

/** `now`: a state as it is in the text of `before`; `current`: the mission as it is there. */
export type TextChange = (before: string, now: (state: EditedState) => EditedState, current: MissionText) => string;
/** Changes the text; what is wrong, or null. */
export type Edit = (change: TextChange) => string | null;
/** Changes the text, unless it would have an error that it has not yet (`segue check`). */
export type CheckedEdit = (change: TextChange) => Promise<string | null>;
export interface Edits {
  edit: Edit;
  checked: CheckedEdit;
}

/** Facts and resources are checked before they are set; the rest of an action may be wrong in between. */
const isDeclaration = (key: unknown) => ['preconditions', 'while', 'effects', 'resources'].includes(String(key));

/** The edits of an action. */
function actionEditsOf(name: string, { edit, checked }: Edits): ActionEdits {
  const ofAction = (one: (text: string, action: ActionText, mission: MissionText) => string): TextChange => (text, _, current) => {
    const action = current.actions.find((each) => each.name === name);
    if (!action) throw new Error('there is no action ' + name + ' any more');
    return one(text, action, current);
  };
  const change = (one: Parameters<typeof ofAction>[0]) => edit(ofAction(one));
  return {
    setEntry: (path, typed, kind): Refusal => (isDeclaration(path[0]) ? checked : edit)(ofAction((text, action) => setEntry(text, action, path, typed, kind))),
    addEntry: (key, typed, kind) => checked(ofAction((text, action) => addEntry(text, pathOf(action), key, typed, kind))),
    setFlag: (flag, on) => void change((text, action) => setFlag(text, action, flag, on)),
    addPort: (side, port, type) => change((text, action) => addActionPort(text, action, side, port, type)),
    setPort: (side, port, type, yaml) => change((text, action) => setActionPort(text, action, side, port, type, yaml)),
    removePort: (side, port) => void change((text, action, current) => removeActionPort(text, current, action, side, port)),
    addOutcome: (outcome) => change((text, action) => addActionOutcome(text, action, outcome)),
    removeOutcome: (outcome) => void change((text, action, current) => removeActionOutcome(text, current, action, outcome)),
  };
}

/** The edits of the state that is selected; each changes the text. */
export function editsOf(state: EditedState, mission: MissionText, edits: Edits, onSelect: (id: string | null) => void): StateEdits {
  const { edit, checked } = edits;
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
    setEntry: (path, typed, kind) => checked((text, now) => setDeclared(text, now(state), path, typed, kind)),
    addEntry: (key, typed, kind) => checked((text, now) => addEntry(text, now(state).path, key, typed, kind)),
    ofAction: (name) => actionEditsOf(name, edits),
  };
}
