// SPDX-License-Identifier: Apache-2.0
// A component that receives satellites.
#include <segue/task/component.hpp>

using namespace segue::task;

class Receiver final : public Component {
 private:
  [[nodiscard]] static bool antenna_works() { return true; }
  [[nodiscard]] static int satellites() { return 4; }
  // the snippet
};
