// SPDX-License-Identifier: Apache-2.0

/** The message of an error. */
export function reason(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
