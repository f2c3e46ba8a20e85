// SPDX-License-Identifier: Apache-2.0
import { isScalar, isSeq } from 'yaml';
import { add, nodeAt, parsed, put, remove } from './yaml_edit';

/** Edits of robot files, each from text to text: the files that they name. */

type Section = 'controllers' | 'missions';

function indexOf(text: string, section: Section, path: string): number {
  const list = nodeAt(parsed(text), [section]);
  return isSeq(list) ? list.items.findIndex((item) => isScalar(item) && item.value === path) : -1;
}

/** Whether a pattern of the robot file, whose last part may contain * and ?, names the file. */
export function isNamed(text: string, section: Section, path: string): boolean {
  const list = nodeAt(parsed(text), [section]);
  const escaped = (part: string) => part.replace(/[.+^${}()|[\]\\]/g, '\\$&').replace(/\*/g, '[^/]*').replace(/\?/g, '[^/]');
  return isSeq(list) && list.items.some((item) => isScalar(item) && new RegExp('^' + escaped(String(item.value).replace(/^\.\//, '')) + '$').test(path));
}

export function nameFile(text: string, section: Section, path: string): string {
  return isNamed(text, section, path) ? text : add(text, [section], path);
}
/** In place of its old name, where the file was named by it. */
export function renameFile(text: string, section: Section, path: string, to: string): string {
  const index = indexOf(text, section, path);
  const without = index < 0 ? text : remove(text, [section, index]);
  if (index >= 0 && !isNamed(without, section, to)) return put(text, [section, index], to);
  return index >= 0 ? without : section === 'controllers' ? nameFile(text, section, to) : text;
}
export function forgetFile(text: string, section: Section, path: string): string {
  const index = indexOf(text, section, path);
  return index < 0 ? text : remove(text, [section, index]);
}
