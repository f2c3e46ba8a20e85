// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Json, JsonMap } from '../robot/change';
import { RobotError } from '../robot/connection';
import { applied, type SemanticEdit } from './semantic';
import { dataOf, SemanticDrafts } from './semantic_drafts';

/** A studio with the semantic data of one state; whatever is called "wrong" is an error. */
function studio() {
  const file = { data: { a: 'x' } as JsonMap, version: 1 };
  const calls: string[] = [];
  const call = async (verb: string, given?: JsonMap): Promise<Json> => {
    calls.push(verb);
    if (verb === 'semantic_data') return { data: file.data, version: String(file.version) };
    if (given?.['version'] !== String(file.version)) throw new RobotError('invalid-state', 'changed by somebody else');
    const edits = given['edits'] as unknown as SemanticEdit[];
    if (verb === 'check_semantic_data') return { problems: edits.some((edit) => edit.value === 'wrong') ? [{ message: 'this is wrong' }] : [] };
    file.data = applied(file.data, edits);
    return { version: String(++file.version) };
  };
  const drafts = new SemanticDrafts({ call } as unknown as ConstructorParameters<typeof SemanticDrafts>[0]);
  const data = () => dataOf(drafts.get('m', 's')!);
  return { file, calls, drafts, data };
}

describe('semantic data that are edited', () => {
  it('are taken back, done again and saved', async () => {
    const { file, drafts, data } = studio();
    await drafts.open('m', 's');
    expect(await drafts.add('m', 's', { keys: ['b'], value: 'y' })).toBeNull();
    expect(await drafts.add('m', 's', { keys: ['a'] })).toBeNull();
    expect(data()).toEqual({ b: 'y' });
    drafts.undo('m', 's');
    expect(data()).toEqual({ a: 'x', b: 'y' });
    drafts.redo('m', 's');
    expect(data()).toEqual({ b: 'y' });
    expect(file.data).toEqual({ a: 'x' });
    expect(drafts.hasUnsaved('m')).toBe(true);
    expect(drafts.hasUnsaved('other')).toBe(false);
    expect(await drafts.save('m', 's')).toBe(true);
    expect(file.data).toEqual({ b: 'y' });
    expect(data()).toEqual({ b: 'y' });
    expect(drafts.hasUnsaved()).toBe(false);
    expect(await drafts.add('m', 's', { keys: ['c'], value: 'z' })).toBeNull();
    expect(await drafts.save('m', 's')).toBe(true);
    expect(file.data).toEqual({ b: 'y', c: 'z' });
  });
  it('do not get what would be wrong', async () => {
    const { drafts, data } = studio();
    await drafts.open('m', 's');
    expect(await drafts.add('m', 's', { keys: ['b'], value: 'wrong' })).toBe('this is wrong');
    expect(data()).toEqual({ a: 'x' });
    expect(drafts.hasUnsaved()).toBe(false);
  });
  it('are not made twice at once', async () => {
    const { drafts, data } = studio();
    await drafts.open('m', 's');
    await Promise.all([drafts.add('m', 's', { keys: ['b'], value: '1' }), drafts.add('m', 's', { keys: ['c'], value: '2' })]);
    expect(data()).toEqual({ a: 'x', b: '1', c: '2' });
  });
  it('stay where somebody else has changed the file, until it is read again', async () => {
    const { file, drafts, data } = studio();
    await drafts.open('m', 's');
    await drafts.add('m', 's', { keys: ['b'], value: 'y' });
    [file.data, file.version] = [{ a: 'theirs' }, 7];
    expect(await drafts.save('m', 's')).toBe(false);
    expect(drafts.get('m', 's')).toMatchObject({ conflict: true, error: 'changed by somebody else', saving: false });
    expect(file.data).toEqual({ a: 'theirs' });
    await drafts.open('m', 's');
    expect(data()).toEqual({ a: 'x', b: 'y' });
    await drafts.readAgain('m', 's');
    expect(data()).toEqual({ a: 'theirs' });
    expect(drafts.get('m', 's')).toMatchObject({ conflict: false, error: '', edits: [] });
  });
  it('are read anew where nothing is unsaved', async () => {
    const { file, drafts, data } = studio();
    await drafts.open('m', 's');
    [file.data, file.version] = [{ a: 'theirs' }, 7];
    await drafts.open('m', 's');
    expect(data()).toEqual({ a: 'theirs' });
  });
});
