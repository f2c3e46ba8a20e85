// SPDX-License-Identifier: Apache-2.0
import { redo, undo } from '@codemirror/commands';
import { yaml } from '@codemirror/lang-yaml';
import { HighlightStyle, syntaxHighlighting } from '@codemirror/language';
import { linter, lintGutter, type Diagnostic } from '@codemirror/lint';
import { EditorState, Prec, type Extension, type TransactionSpec } from '@codemirror/state';
import { EditorView, keymap } from '@codemirror/view';
import { tags } from '@lezer/highlight';
import { basicSetup } from 'codemirror';
import { reason } from '../reason';
import type { Json } from '../robot/change';
import { RobotError, type Connection } from '../robot/connection';
import { changeBetween } from './yaml_edit';

export interface Problem {
  severity: 'error' | 'warning';
  code: string;
  message: string;
  /** Counted from 1; 0: not known. */
  line: number;
  column: number;
}

export interface FileEntry {
  path: string;
  kind: 'robot' | 'network' | 'mission' | 'rafcon';
  /** Whether the robot file names it. */
  named: boolean;
  problem: string;
}

/** A file as it is edited: outlives the view, with its undo history. */
export interface Draft {
  path: string;
  /** The text that was read or saved last. */
  saved: string;
  version: string;
  /** Lines end in CR LF in the file; here they never do. */
  carriageReturns: boolean;
  state: EditorState;
  /** The problems of this text; null: not checked yet. */
  problems: Problem[] | null;
  /** Why it could not be saved, or checked. */
  error: string;
  /** The file is another one now. */
  conflict: string;
  /** The own text, when the other one was read in its place. */
  kept: string | null;
  saving: boolean;
  /** A state machine of RAFCON, as the mission that it becomes. */
  isReadOnly: boolean;
  /** The parts of the state machine that the mission could not keep. */
  notes: string[];
  /** The folders of its states, by their paths in the mission. */
  folders: Record<string, string>;
}

const colours = HighlightStyle.define([
  { tag: [tags.propertyName, tags.definition(tags.propertyName)], color: 'var(--accent)' },
  { tag: tags.comment, color: 'var(--quiet)', fontStyle: 'italic' },
  { tag: [tags.string, tags.special(tags.string)], color: 'var(--good)' },
  { tag: [tags.labelName, tags.typeName], color: 'var(--warn)' },
]);

const look = EditorView.theme({
  '&': { height: '100%', color: 'var(--text)', backgroundColor: 'var(--front)', fontSize: '12.5px' },
  '&.cm-focused': { outline: '2px solid var(--accent)', outlineOffset: '-2px' },
  '.cm-scroller': { fontFamily: "ui-monospace, 'DejaVu Sans Mono', monospace", lineHeight: '1.5' },
  '.cm-content': { caretColor: 'var(--text)' },
  '.cm-cursor': { borderLeftColor: 'var(--text)' },
  '.cm-gutters': { backgroundColor: 'var(--back)', color: 'var(--quiet)', borderRight: '1px solid var(--line)' },
  '.cm-activeLine, .cm-activeLineGutter': { backgroundColor: 'transparent' },
  '&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground': { backgroundColor: 'var(--come-back)' },
  '.cm-tooltip, .cm-panels': { backgroundColor: 'var(--front)', color: 'var(--text)', border: '1px solid var(--line)' },
  '.cm-textfield, .cm-button': { background: 'var(--front)', color: 'var(--text)', border: '1px solid var(--line)' },
});

const notChecked = 'not checked: ';

/** The answer to the request `read_file`. */
interface FileText {
  text: string;
  version: string;
  notes: string[];
  /** Of machines of RAFCON. */
  folders?: Record<string, string>;
}

function place(state: EditorState, problem: Problem): Diagnostic {
  const line = state.doc.line(Math.min(Math.max(problem.line, 1), state.doc.lines));
  const from = Math.min(line.from + Math.max(problem.column - 1, 0), line.to);
  const word = /^[\w.:/-]+/.exec(state.doc.sliceString(from, line.to))?.[0].length ?? 0;
  return { from, to: Math.min(from + word, line.to), severity: problem.severity, message: problem.message, source: problem.code };
}

export class Drafts {
  private readonly drafts = new Map<string, Draft>();
  private readonly listeners = new Set<() => void>();
  private view: { path: string; view: EditorView } | null = null;

  constructor(private readonly connection: Connection) {
    window.addEventListener('beforeunload', (event) => {
      if ([...this.drafts.values()].some((draft) => this.isUnsaved(draft))) event.preventDefault();
    });
  }

  subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };
  get(path: string | null): Draft | null {
    return (path !== null && this.drafts.get(path)) || null;
  }
  isUnsaved(draft: Draft | null): boolean {
    return draft !== null && draft.state.doc.toString() !== draft.saved;
  }

  /** Reads the file, unless it is edited already. Rejected with a RobotError. */
  async open(path: string): Promise<void> {
    if (this.drafts.has(path)) return;
    const { text, version, notes, folders } = await this.read(path);
    if (this.drafts.has(path)) return;
    const isReadOnly = version === '';
    const state = EditorState.create({ doc: text, extensions: this.extensions(path, isReadOnly) });
    this.set({ path, isReadOnly, notes, folders: folders ?? {}, saved: state.doc.toString(), version, carriageReturns: text.includes('\r\n'), state, problems: null, error: '', conflict: '', kept: null, saving: false });
  }

  /** Where the text is shown. */
  show(path: string, parent: ShadowRoot): () => void {
    const draft = this.drafts.get(path);
    if (!draft) return () => undefined;
    const view = new EditorView({
      state: draft.state, parent, root: parent,
      dispatchTransactions: (transactions, shown) => {
        shown.update(transactions);
        this.patch(path, { state: shown.state });
      },
    });
    this.view = { path, view };
    return () => {
      if (this.view?.view === view) this.view = null;
      view.destroy();
    };
  }

  /** Replaces the text, as one step that can be undone. */
  replace(path: string, text: string): void {
    const draft = this.drafts.get(path);
    if (draft) this.dispatch(path, { changes: changeBetween(draft.state.doc.toString(), text), userEvent: 'input' });
  }
  jump(path: string, at: number): void {
    const draft = this.drafts.get(path);
    if (!draft) return;
    const anchor = Math.min(at, draft.state.doc.length);
    this.dispatch(path, { selection: { anchor }, effects: EditorView.scrollIntoView(anchor, { y: 'center' }) });
  }
  lineStart(path: string, line: number, column: number): number {
    const state = this.drafts.get(path)?.state;
    return state ? place(state, { line, column, severity: 'error', code: '', message: '' }).from : 0;
  }
  focus(): void {
    this.view?.view.focus();
  }
  undo(path: string): void {
    if (this.view?.path === path) undo(this.view.view);
  }
  redo(path: string): void {
    if (this.view?.path === path) redo(this.view.view);
  }

  async save(path: string): Promise<void> {
    const draft = this.drafts.get(path);
    if (!draft || draft.saving || draft.isReadOnly || !this.connection.mayOperate) return;
    const text = draft.state.doc.toString();
    this.patch(path, { saving: true, error: '', conflict: '' });
    try {
      const answer = (await this.connection.call('save_file', { path, text: draft.carriageReturns ? text.replace(/\n/g, '\r\n') : text, version: draft.version })) as { version: string };
      this.patch(path, { saving: false, saved: text, version: answer.version });
    } catch (error) {
      const conflict = error instanceof RobotError && error.code === 'invalid-state';
      this.patch(path, { saving: false, [conflict ? 'conflict' : 'error']: reason(error) });
    }
  }

  /** The file in place of the text; the text comes back by undo, and is shown to be copied where it is kept. */
  async readAgain(path: string, keep: boolean): Promise<void> {
    const mine = this.drafts.get(path)?.state.doc.toString() ?? '';
    try {
      const { text, version } = await this.read(path);
      this.replace(path, text.replace(/\r\n?/g, '\n'));
      this.patch(path, { saved: this.drafts.get(path)?.state.doc.toString() ?? text, version, carriageReturns: text.includes('\r\n'), conflict: '', error: '', kept: keep ? mine : null });
    } catch (error) {
      this.patch(path, { error: reason(error) });
    }
  }
  dropKept(path: string): void {
    this.patch(path, { kept: null });
  }

  /** Its file has gone, or another name. */
  forget(path: string): void {
    this.drafts.delete(path);
    for (const listener of this.listeners) listener();
  }

  /** The first error that the file would have with the text `after` and does not have with `before`; null: none. */
  async newError(path: string, before: string, after: string): Promise<string | null> {
    const errors = async (text: string) => (await this.problemsOf(path, text)).filter((problem) => problem.severity === 'error').map((problem) => problem.message);
    try {
      const known = new Set(await errors(before));
      return (await errors(after)).find((message) => !known.has(message)) ?? null;
    } catch (error) {
      return notChecked + reason(error);
    }
  }

  private async read(path: string): Promise<FileText> {
    return (await this.connection.call('read_file', { path })) as unknown as FileText;
  }
  private async problemsOf(path: string, text: string): Promise<Problem[]> {
    const answer = await this.connection.call('check_file', { path, text });
    return (answer as { problems: Json }).problems as unknown as Problem[];
  }

  private async check(path: string, state: EditorState): Promise<Diagnostic[]> {
    try {
      const problems = await this.problemsOf(path, state.doc.toString());
      if (this.drafts.get(path)?.state.doc.eq(state.doc)) this.checked(path, problems);
      return problems.map((problem) => place(state, problem));
    } catch (error) {
      this.patch(path, { problems: null, error: notChecked + reason(error) });
      return [];
    }
  }

  private checked(path: string, problems: Problem[]): void {
    const error = this.drafts.get(path)?.error ?? '';
    this.patch(path, { problems, error: error.startsWith(notChecked) ? '' : error });
  }

  private extensions(path: string, isReadOnly: boolean): Extension[] {
    return [
      Prec.highest(keymap.of([{ key: 'Mod-s', preventDefault: true, run: () => (void this.save(path), true) }])),
      basicSetup, yaml(), syntaxHighlighting(colours), look,
      linter((view) => this.check(path, view.state), { delay: 350 }), lintGutter(),
      EditorState.readOnly.of(isReadOnly || !this.connection.mayOperate),
      EditorView.contentAttributes.of({ 'aria-label': 'Text of ' + path, tabindex: '0' }),
    ];
  }

  private dispatch(path: string, change: TransactionSpec): void {
    if (this.view?.path === path) return this.view.view.dispatch(change);
    const draft = this.drafts.get(path);
    if (draft) this.patch(path, { state: draft.state.update(change).state });
  }
  private patch(path: string, change: Partial<Draft>): void {
    const draft = this.drafts.get(path);
    if (draft) this.set({ ...draft, ...change });
  }
  private set(draft: Draft): void {
    this.drafts.set(draft.path, draft);
    for (const listener of this.listeners) listener();
  }
}

const all = new WeakMap<Connection, Drafts>();
/** The drafts of this page: they stay while other views are shown. */
export function draftsOf(connection: Connection): Drafts {
  let drafts = all.get(connection);
  if (!drafts) all.set(connection, (drafts = new Drafts(connection)));
  return drafts;
}
