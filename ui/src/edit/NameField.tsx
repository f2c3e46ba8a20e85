// SPDX-License-Identifier: Apache-2.0
import { useId, useState } from 'react';

/** A name that is changed by typing and Enter. `onRename` says why not, or null. */
export function NameField({ label, name, onRename }: { label: string; name: string; onRename: (name: string) => string | null }) {
  const [typed, setTyped] = useState<string | null>(null);
  const [problem, setProblem] = useState<string | null>(null);
  const id = useId();
  return (
    <form
      className="row property"
      onSubmit={(event) => {
        event.preventDefault();
        if (typed === null || typed.trim() === name) return setTyped(null);
        const refused = onRename(typed.trim());
        setProblem(refused);
        if (refused === null) setTyped(null);
      }}
    >
      <label htmlFor={id}>{label}</label>
      <input
        id={id} value={typed ?? name} spellCheck={false} className={typed !== null ? 'edited' : ''} onChange={(event) => setTyped(event.target.value)}
        onKeyDown={(event) => {
          if (event.key === 'Escape') [setTyped(null), setProblem(null)];
        }}
      />
      {typed !== null && typed.trim() !== name && <button type="submit">Rename</button>}
      {problem && <output className="bad">{problem}</output>}
    </form>
  );
}
