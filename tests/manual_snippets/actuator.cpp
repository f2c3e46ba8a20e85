// SPDX-License-Identifier: Apache-2.0
// A component that follows a velocity.
#include <segue/components/demo/types.hpp>
#include <segue/task/component.hpp>

using namespace segue::task;
using demo::Velocity;

class Actuator final : public Component {
 private:
  // the snippet
  Velocity velocity_;
};
