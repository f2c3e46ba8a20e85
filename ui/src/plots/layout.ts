// SPDX-License-Identifier: Apache-2.0
import { hasOwn, kindNames, pathText, type PanelKind, type Path } from './fields';

/** A part of the samples of a port. */
export interface Source {
  task: string;
  port: string;
  path: Path;
}

export interface Panel {
  /** Only in this page, not in files. */
  id: number;
  kind: PanelKind;
  title: string;
  /** The width in columns; the page has three. */
  columns: number;
  rows: number;
  /** How much of the past is shown: of plots over time and of trails in maps. */
  seconds: number;
  sources: Source[];
}

export class LayoutError extends Error {}

export const version = 1;
export const mostPanels = 24;
export const mostSources = 16;
/** The limit of all panels together; the studio lets a browser look at 64 documents. */
export const mostPorts = 48;
export const windows = [10, 30, 60, 300, 600];
const longestFile = 1 << 18;
const longestText = 255;
const deepestPath = 16;

export function documentOf(source: Source): string {
  return 'port/' + source.task + '/' + source.port;
}

export function sourceText(source: Source): string {
  const path = pathText(source.path);
  return source.task + '.' + source.port + (path === '' ? '' : (path.startsWith('[') ? '' : ' ') + path);
}

export function portsOf(panels: Panel[]): Set<string> {
  return new Set(panels.flatMap((panel) => panel.sources.map(documentOf)));
}

let lastId = 0;
export function newId(): number {
  return ++lastId;
}

export function layoutText(panels: Panel[]): string {
  const shown = panels.map((panel) => ({
    kind: panel.kind,
    title: panel.title,
    columns: panel.columns,
    rows: panel.rows,
    seconds: panel.seconds,
    sources: panel.sources,
  }));
  return JSON.stringify({ segue_layout: version, panels: shown }, null, 2) + '\n';
}

type Unknown = { [key: string]: unknown };

function fail(where: string, what: string): never {
  throw new LayoutError(where + ' ' + what);
}

function mapAt(value: unknown, where: string, keys: string[]): Unknown {
  if (typeof value !== 'object' || value === null || Array.isArray(value)) fail(where, 'is not a map');
  for (const key of Object.keys(value)) if (!keys.includes(key)) fail(where, 'has an unknown key ' + JSON.stringify(key.slice(0, 40)));
  return value as Unknown;
}

function listAt(value: unknown, where: string, most: number): unknown[] {
  if (!Array.isArray(value)) fail(where, 'is not a list');
  if (value.length > most) fail(where, 'has ' + value.length + ' entries; ' + most + ' are the most');
  return value;
}

function textAt(value: unknown, where: string): string {
  if (typeof value !== 'string') fail(where, 'is not text');
  if (value.length > longestText) fail(where, 'is longer than ' + longestText + ' characters');
  return value;
}

/** The name of a task or port, in the form that the robot uses. */
function nameAt(value: unknown, where: string): string {
  const name = textAt(value, where);
  if (!/^[A-Za-z0-9_][A-Za-z0-9_.:-]*$/.test(name)) fail(where, 'is not the name of a task or port: ' + JSON.stringify(name.slice(0, 40)));
  return name;
}

function wholeAt(value: unknown, where: string, least: number, most: number): number {
  if (typeof value !== 'number' || !Number.isInteger(value) || value < least || value > most)
    fail(where, 'is not an integer from ' + least + ' to ' + most);
  return value;
}

function sourceAt(value: unknown, where: string): Source {
  const map = mapAt(value, where, ['task', 'port', 'path']);
  return {
    task: nameAt(map['task'], where + '.task'),
    port: nameAt(map['port'], where + '.port'),
    path: listAt(map['path'], where + '.path', deepestPath).map((key, index) => textAt(key, where + '.path[' + index + ']')),
  };
}

function panelAt(value: unknown, where: string): Panel {
  const map = mapAt(value, where, ['kind', 'title', 'columns', 'rows', 'seconds', 'sources']);
  const kind = textAt(map['kind'], where + '.kind');
  if (!hasOwn(kindNames, kind)) fail(where + '.kind', 'is none of ' + Object.keys(kindNames).join(', '));
  const sources = listAt(map['sources'], where + '.sources', kind === 'image' ? 1 : mostSources);
  if (sources.length === 0) fail(where + '.sources', 'is empty');
  return {
    id: newId(),
    kind: kind as PanelKind,
    title: textAt(map['title'], where + '.title'),
    columns: wholeAt(map['columns'], where + '.columns', 1, 3),
    rows: wholeAt(map['rows'], where + '.rows', 1, 3),
    seconds: wholeAt(map['seconds'], where + '.seconds', 1, 600),
    sources: sources.map((source, index) => sourceAt(source, where + '.sources[' + index + ']')),
  };
}

/** Throws a LayoutError that says where the text is not a layout. */
export function parseLayout(text: string): Panel[] {
  if (text.length > longestFile) throw new LayoutError('it is longer than ' + (longestFile >> 10) + ' KiB');
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch (error) {
    throw new LayoutError('it is not JSON: ' + (error instanceof Error ? error.message.slice(0, 120) : ''));
  }
  if (typeof value !== 'object' || value === null || !hasOwn(value, 'segue_layout'))
    throw new LayoutError('it is not a layout of Segue Studio: the key "segue_layout" is missing');
  const map = mapAt(value, 'the layout', ['segue_layout', 'panels']);
  if (map['segue_layout'] !== version)
    throw new LayoutError('it is a layout of version ' + JSON.stringify(map['segue_layout'])?.slice(0, 20) + '; this page reads version ' + version);
  const panels = listAt(map['panels'], 'panels', mostPanels).map((panel, index) => panelAt(panel, 'panels[' + index + ']'));
  const ports = portsOf(panels).size;
  if (ports > mostPorts) fail('the layout', 'shows ' + ports + ' ports; ' + mostPorts + ' are the most');
  return panels;
}
