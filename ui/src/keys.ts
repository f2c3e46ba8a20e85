// SPDX-License-Identifier: Apache-2.0

const pressed = new Set(['button', 'checkbox', 'file', 'radio', 'reset', 'submit']);

/** Whether a key goes into a field, and so is none of the page's. */
export function isTyping(event: KeyboardEvent): boolean {
  const { target } = event;
  if (target instanceof HTMLInputElement) return !pressed.has(target.type);
  return target instanceof HTMLElement && (['TEXTAREA', 'SELECT'].includes(target.tagName) || target.isContentEditable);
}
