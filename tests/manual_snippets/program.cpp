// SPDX-License-Identifier: Apache-2.0
// A function that returns the program's status.
int program() {
  // the snippet
  return 0;
}
