// SPDX-License-Identifier: Apache-2.0
import { reason } from '../reason';
import type { Json, JsonMap } from '../robot/change';
import { RobotError, type Connection } from '../robot/connection';
import type { Problem } from './drafts';
import { applied, type SemanticEdit } from './semantic';

/** The semantic data of one state as they are edited: they outlive the view. */
export interface SemanticDraft {
  /** The machine, and the folder of the state in it. */
  path: string;
  state: string;
  /** As in the file. */
  saved: JsonMap;
  /** Empty: there is no file. */
  version: string;
  edits: SemanticEdit[];
  /** Edits that were taken back, the next one to be done again last. */
  undone: SemanticEdit[];
  saving: boolean;
  /** Why they could not be read or saved. */
  error: string;
  /** Somebody else has changed the file. */
  conflict: boolean;
}

const keyOf = (path: string, state: string) => path + '/' + state;
export const dataOf = (draft: SemanticDraft) => applied(draft.saved, draft.edits);

export class SemanticDrafts {
  private readonly drafts = new Map<string, SemanticDraft>();
  private readonly listeners = new Set<() => void>();

  constructor(private readonly connection: Pick<Connection, 'call'>) {}

  subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };
  get(path: string, state: string): SemanticDraft | null {
    return this.drafts.get(keyOf(path, state)) ?? null;
  }
  /** Of a machine, or any. */
  hasUnsaved(path?: string): boolean {
    return [...this.drafts.values()].some((draft) => (path === undefined || draft.path === path) && draft.edits.length > 0);
  }

  /** Reads the file, unless there are edits of it. */
  async open(path: string, state: string): Promise<void> {
    const known = this.get(path, state);
    if (!known || known.edits.length === 0) await this.readAgain(path, state);
  }

  /** The file in place of the edits. */
  async readAgain(path: string, state: string): Promise<void> {
    const empty = { path, state, saved: {}, version: '', edits: [], undone: [], saving: false, error: '', conflict: false };
    try {
      const { data, version } = (await this.connection.call('semantic_data', { path, state })) as { data: JsonMap; version: string };
      this.set({ ...empty, saved: data, version });
    } catch (error) {
      this.set({ ...(this.get(path, state) ?? empty), error: reason(error) });
    }
  }

  /** Makes the edit if it leads to no error in the machine; else says which, and makes none. */
  async add(path: string, state: string, edit: SemanticEdit): Promise<string | null> {
    for (;;) {
      const draft = this.get(path, state);
      if (!draft) return 'the semantic data are not known';
      const edits = [...draft.edits, edit];
      const refused = await this.check(draft, edits);
      if (this.get(path, state)?.edits !== draft.edits) continue; // others were made meanwhile
      if (refused === null) this.patch(draft, { edits, undone: [] });
      return refused;
    }
  }

  undo(path: string, state: string): void {
    const draft = this.get(path, state);
    const last = draft?.edits[draft.edits.length - 1];
    if (draft && last) this.patch(draft, { edits: draft.edits.slice(0, -1), undone: [...draft.undone, last] });
  }
  redo(path: string, state: string): void {
    const draft = this.get(path, state);
    const next = draft?.undone[draft.undone.length - 1];
    if (draft && next) this.patch(draft, { edits: [...draft.edits, next], undone: draft.undone.slice(0, -1) });
  }

  /** Whether they were saved. */
  async save(path: string, state: string): Promise<boolean> {
    const draft = this.get(path, state);
    if (!draft || draft.saving || draft.edits.length === 0) return false;
    const { edits, version } = draft;
    this.patch(draft, { saving: true, error: '', conflict: false });
    try {
      const answer = (await this.connection.call('save_semantic_data', { path, state, version, edits: edits as unknown as Json })) as { version: string };
      const now = this.get(path, state) ?? draft;
      // Edits that were made meanwhile are still to be saved.
      const isAhead = edits.every((edit, index) => now.edits[index] === edit);
      this.patch(draft, { saving: false, saved: applied(draft.saved, edits), version: answer.version, edits: isAhead ? now.edits.slice(edits.length) : [], undone: [] });
      return true;
    } catch (error) {
      this.patch(draft, { saving: false, error: reason(error), conflict: error instanceof RobotError && error.code === 'invalid-state' });
      return false;
    }
  }

  private async check(draft: SemanticDraft, edits: SemanticEdit[]): Promise<string | null> {
    const { path, state, version } = draft;
    try {
      const answer = await this.connection.call('check_semantic_data', { path, state, version, edits: edits as unknown as Json });
      const problems = (answer as { problems: Json }).problems as unknown as Problem[];
      return problems.length === 0 ? null : problems.map((problem) => problem.message).join('; ');
    } catch (error) {
      if (error instanceof RobotError && error.code === 'invalid-state') this.patch(draft, { error: reason(error), conflict: true });
      return reason(error);
    }
  }

  private patch(draft: SemanticDraft, change: Partial<SemanticDraft>): void {
    const now = this.get(draft.path, draft.state);
    if (now) this.set({ ...now, ...change });
  }
  private set(draft: SemanticDraft): void {
    this.drafts.set(keyOf(draft.path, draft.state), draft);
    for (const listener of this.listeners) listener();
  }
}

const all = new WeakMap<Connection, SemanticDrafts>();
/** Those of this page: they stay while other views are shown. */
export function semanticDraftsOf(connection: Connection): SemanticDrafts {
  let drafts = all.get(connection);
  if (!drafts) {
    const made = (drafts = new SemanticDrafts(connection));
    all.set(connection, made);
    window.addEventListener('beforeunload', (event) => {
      if (made.hasUnsaved()) event.preventDefault();
    });
  }
  return drafts;
}
