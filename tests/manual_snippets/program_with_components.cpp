// SPDX-License-Identifier: Apache-2.0
// A function that returns the program's status, in a program with two components.
#include <segue/task/component.hpp>

class Source final : public segue::task::Component {
 public:
  segue::task::OutputPort<int> out{*this, "out"};
};

class Sink final : public segue::task::Component {
 public:
  segue::task::InputPort<int> in{*this, "in"};
};

int program() {
  // the snippet
  return 0;
}
