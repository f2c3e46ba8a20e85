// SPDX-License-Identifier: Apache-2.0

/**
 * Keeps the objects of a list from one drawing to the next as long as the parts that they are made of are the same, so
 * that what compares objects by identity sees only what has changed. Between begin() and end() each id is kept once.
 */
export class Keeper<T> {
  private before = new Map<string, { parts: unknown[]; made: T }>();
  private now = new Map<string, { parts: unknown[]; made: T }>();

  begin(): this {
    this.now = new Map();
    return this;
  }

  keep(id: string, parts: unknown[], make: () => T): T {
    const known = this.before.get(id);
    const same = known !== undefined && known.parts.length === parts.length && known.parts.every((part, index) => part === parts[index]);
    const entry = same ? known : { parts, made: make() };
    this.now.set(id, entry);
    return entry.made;
  }

  /** Forgets everything that was not kept since begin(). */
  end(): void {
    this.before = this.now;
  }
}
