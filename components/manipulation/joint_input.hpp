// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/sensors.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace manipulation {

/// The input port `joints` of a component: what the driver of its arm reports. For the hooks of its
/// component; real-time safe.
class JointInput {
 public:
  explicit JointInput(segue::task::Component& component)
      : port_(component, "joints", {.doc = "of the arm, in the order of the property that describes them"}) {}

  /// Forgets what has arrived; from now on samples must have `size` positions.
  void begin(std::size_t size) {
    size_ = size;
    sample_ = {};
  }
  /// Takes what has arrived. False if nothing that can be used did within `timeout`.
  bool read(segue::TimePoint now, segue::Duration timeout) {
    while (auto sample = port_.take()) {
      if (!usable(*sample)) continue;
      sample_ = std::move(sample);
      arrived_ = now;
    }
    return sample_ && now - arrived_ <= timeout;
  }
  /// These functions require that read() was true.
  [[nodiscard]] double time() const { return sample_->time; }
  [[nodiscard]] std::span<const double> positions() const { return sample_->positions; }
  /// The velocity of one joint; 0 where the driver does not know it.
  [[nodiscard]] double velocity(std::size_t joint) const {
    return joint < sample_->velocities.size() && std::isfinite(sample_->velocities[joint])
               ? sample_->velocities[joint]
               : 0;
  }

 private:
  [[nodiscard]] bool usable(const messages::JointState& state) const {
    return state.positions.size() == size_ &&
           std::ranges::all_of(state.positions, [](double position) { return std::isfinite(position); });
  }

  segue::task::InputPort<messages::JointState> port_;
  segue::task::Sample<messages::JointState> sample_;
  segue::TimePoint arrived_;
  std::size_t size_ = 0;
};

}  // namespace manipulation
