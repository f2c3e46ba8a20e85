// SPDX-License-Identifier: Apache-2.0
// A function that returns the program's status, in a program that can grasp.
#include <segue/mission/action_runner.hpp>
#include <segue/type/value.hpp>

segue::mission::Ending grasp(const segue::type::Value& pose);

int program() {
  // the snippet
  return 0;
}
