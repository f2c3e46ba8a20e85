// SPDX-License-Identifier: Apache-2.0

/** Says how many versions of something this browser has not got, if any. */
export function Skipped({ count }: { count: number | undefined }) {
  if (!count) return null;
  return <span className="quiet"> {count} updates skipped: this browser, or its connection, was too slow.</span>;
}
