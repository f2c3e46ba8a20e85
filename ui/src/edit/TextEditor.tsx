// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef } from 'react';
import type { Drafts } from './drafts';

/**
 * The text of a draft. In a shadow root, because the editor's styles are adopted there: as an element of the page, the
 * content security policy forbids them.
 */
export function TextEditor({ drafts, path }: { drafts: Drafts; path: string }) {
  const host = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const element = host.current;
    if (!element) return;
    const root = element.shadowRoot ?? element.attachShadow({ mode: 'open' });
    // Keys that are typed here are not shortcuts of the page.
    const keep = (event: KeyboardEvent) => event.stopPropagation();
    element.addEventListener('keydown', keep);
    const hide = drafts.show(path, root);
    return () => {
      element.removeEventListener('keydown', keep);
      hide();
    };
  }, [drafts, path]);
  return <div className="text-editor" ref={host} />;
}
