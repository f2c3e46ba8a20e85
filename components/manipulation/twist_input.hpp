// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/geometry.hpp"

#include <segue/task/component.hpp>

#include <optional>
#include <string>
#include <utility>

namespace manipulation {

/// The input port `twist` of a component: what it is told to move by. For the hooks of its component;
/// real-time safe.
class TwistInput {
 public:
  TwistInput(segue::task::Component& component, std::string doc)
      : port_(component, "twist", {.doc = std::move(doc)}) {}

  /// Forgets what has arrived.
  void begin() { arrived_.reset(); }
  /// Takes what has arrived; twists that are not finite are ignored. False if none did within `timeout`.
  bool read(segue::TimePoint now, segue::Duration timeout) {
    messages::Twist twist;
    if (port_.read(twist) == segue::task::ReadStatus::NewData && twist.linear.allFinite() &&
        twist.angular.allFinite()) {
      twist_ = twist;
      arrived_ = now;
    }
    return arrived_ && now - *arrived_ <= timeout;
  }
  /// The last one that was finite; only fresh where read() was true.
  [[nodiscard]] const messages::Twist& twist() const { return twist_; }

 private:
  segue::task::InputPort<messages::Twist> port_;
  messages::Twist twist_;
  std::optional<segue::TimePoint> arrived_;
};

}  // namespace manipulation
