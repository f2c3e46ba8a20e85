// SPDX-License-Identifier: Apache-2.0
import { reason } from '../reason';
import { layoutText, parseLayout, type Panel } from './layout';

const keyOf = (robot: string) => 'segue-studio-plots/' + robot;

/** The layout that this browser keeps for a robot; the problem where it cannot be read. */
export function storedLayout(robot: string): { panels: Panel[]; problem: string } {
  try {
    const text = window.localStorage.getItem(keyOf(robot));
    return { panels: text === null ? [] : parseLayout(text), problem: '' };
  } catch (error) {
    return { panels: [], problem: 'The layout that this browser has kept cannot be read: ' + reason(error) };
  }
}

/** A text that says why it was not kept; empty: it was. */
export function keepLayout(robot: string, panels: Panel[]): string {
  try {
    window.localStorage.setItem(keyOf(robot), layoutText(panels));
    return '';
  } catch (error) {
    return 'This browser does not keep the layout: ' + reason(error);
  }
}

export function download(name: string, text: string): void {
  const address = URL.createObjectURL(new Blob([text], { type: 'application/json' }));
  const link = document.createElement('a');
  link.href = address;
  link.download = name;
  link.click();
  URL.revokeObjectURL(address);
}
