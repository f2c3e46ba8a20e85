// SPDX-License-Identifier: Apache-2.0
import { useId, type ButtonHTMLAttributes, type MouseEvent } from 'react';

interface Props extends Omit<ButtonHTMLAttributes<HTMLButtonElement>, 'disabled'> {
  /** Why it cannot be pressed now, in a few words such as "needs a name"; '': it can. */
  whyNot: string;
  /** The reason is shown while the pointer or the focus is at the button, for bars of several buttons; else beside it. */
  tip?: boolean;
}

/** A button that says why it cannot be pressed. It keeps the focus and its description, which `disabled` would take from it. */
export function ActionButton({ whyNot, tip, title, onClick, ...rest }: Props) {
  const id = useId();
  const press = (event: MouseEvent<HTMLButtonElement>) => {
    if (whyNot !== '') event.preventDefault(); // a form is not submitted, by Enter in a field of it, either
    else onClick?.(event);
  };
  return (
    <span className="action">
      <button {...rest} title={whyNot === '' ? title : undefined} aria-disabled={whyNot !== '' || undefined} aria-describedby={whyNot === '' ? rest['aria-describedby'] : id} onClick={press} />
      {whyNot !== '' && <small id={id} className={tip ? 'why-not tip' : 'why-not'}>{whyNot}</small>}
    </span>
  );
}
