// SPDX-License-Identifier: Apache-2.0
// A task of Segue between nodes of ROS 2: counts the scans that it gets, and those that it did not get.
#include <segue/task/component.hpp>
#include <segue/type/describe.hpp>

#include <cstdint>

namespace std_msgs {
/// The members of std_msgs/msg/UInt64, so that ports of that message can be connected with those of this
/// struct.
struct UInt64 {
  std::uint64_t data = 0;
};
SEGUE_TYPE(UInt64, data)
}  // namespace std_msgs

namespace example {

using namespace segue::task;

struct Scans {
  std::uint64_t received = 0;
  std::uint64_t lost = 0;
};
SEGUE_TYPE(Scans, received, lost)

class ScanMonitor : public Component {
 public:
  ScanMonitor() : Component({.doc = "Counts numbered scans, and those that are missing between them"}) {}

 protected:
  segue::Result<void> on_start() override {
    scans_ = {};
    last_ = 0;
    return {};
  }

  void on_update() override {
    while (const auto scan = scan_.take()) {
      if (last_ != 0 && scan->data > last_ + 1) scans_.lost += scan->data - last_ - 1;
      last_ = scan->data;
      ++scans_.received;
    }
  }

 private:
  InputPort<std_msgs::UInt64> scan_{*this, "scan"};
  Operation<Scans()> count_{*this, "count", {}, [this] { return scans_; }};
  Scans scans_;
  std::uint64_t last_ = 0;
};

}  // namespace example

SEGUE_COMPONENT(example::ScanMonitor)
