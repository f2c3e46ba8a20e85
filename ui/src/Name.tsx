// SPDX-License-Identifier: Apache-2.0
import { Fragment } from 'react';

/** A name or path that is broken behind "_", "/", "." and "-" where it is too long for its line. */
export function Name({ text }: { text: string }) {
  return <>{(text.match(/[^_/.-]*[_/.-]?/g) ?? []).map((part, index) => <Fragment key={index}>{index > 0 && <wbr />}{part}</Fragment>)}</>;
}
