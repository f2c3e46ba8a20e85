// SPDX-License-Identifier: Apache-2.0

/** What an error says. */
export function reason(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
