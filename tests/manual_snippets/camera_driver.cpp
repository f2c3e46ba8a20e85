// SPDX-License-Identifier: Apache-2.0
// A component with as many outputs as it has cameras.
#include <segue/components/messages/sensors.hpp>
#include <segue/task/component.hpp>

#include <memory>
#include <string>
#include <vector>

using namespace segue::task;
using messages::Image;

class CameraDriver final : public Component {
 private:
  Property<std::vector<std::string>> cameras_{*this, "cameras", {}};
  // the snippet
  std::vector<std::unique_ptr<OutputPort<Image>>> images_;
};
