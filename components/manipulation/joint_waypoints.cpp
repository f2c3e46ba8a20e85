// SPDX-License-Identifier: Apache-2.0
#include "joint_input.hpp"
#include "types.hpp"

#include <segue/base/text.hpp>
#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace manipulation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Brings an arm to configurations that have names, one after the other.
class JointWaypoints final : public Component {
 public:
  JointWaypoints()
      : Component({.doc = "Commands named configurations of an arm, one after the other",
                   .activity = segue::periodic(std::chrono::milliseconds(20))}) {}

 private:
  segue::Result<void> on_configure() override {
    if (waypoints_->empty() || waypoints_->front().positions.empty())
      return segue::fail(segue::ErrorCode::InvalidArgument, "waypoints needs an entry with positions");
    const std::size_t size = waypoints_->front().positions.size();
    for (const Waypoint& waypoint : *waypoints_) {
      if (waypoint.positions.size() != size) {
        return segue::fail(segue::ErrorCode::InvalidArgument,
                           "waypoint " + segue::quote(waypoint.name) + " has " +
                               std::to_string(waypoint.positions.size()) + " positions, the first one has " +
                               std::to_string(size));
      }
    }
    route_.clear();
    for (const std::string& name : *sequence_) {
      auto found = find(name);
      if (!found) return std::move(found.error());
      route_.push_back(*found);
    }
    route_.reserve(1);  // what go_to needs
    command_.positions.assign(size, 0);
    command_out_.prime(command_);
    return {};
  }

  segue::Result<void> on_start() override {
    joints_.begin(command_.positions.size());
    next_ = 0;
    return {};
  }

  void on_update() override {
    const bool known = joints_.read(now(), *timeout_);
    if (route_.empty()) {
      idle_.enter();
      return;
    }
    if (!known) {
      waiting_.enter();
      return;
    }
    while (next_ < route_.size() && at(target(next_)))
      ++next_;
    const std::size_t shown = std::min(next_, route_.size() - 1);
    std::ranges::copy(target(shown).positions, command_.positions.begin());
    command_.time = std::chrono::duration<double>(now().time_since_epoch()).count();
    command_out_.write(command_);
    (next_ == route_.size() ? reached_ : moving_).enter();
  }

  [[nodiscard]] const Waypoint& target(std::size_t index) const { return (*waypoints_)[route_[index]]; }
  [[nodiscard]] bool at(const Waypoint& waypoint) const {
    const auto close = [this](double a, double b) { return std::abs(a - b) <= *tolerance_; };
    return std::ranges::equal(joints_.positions(), waypoint.positions, close);
  }
  [[nodiscard]] segue::Result<std::size_t> find(const std::string& name) const {
    const auto found = std::ranges::find(*waypoints_, name, &Waypoint::name);
    if (found == waypoints_->end()) {
      return segue::fail(segue::ErrorCode::NotFound,
                         "there is no waypoint " + segue::quote(name) + ": add it to the property waypoints");
    }
    return static_cast<std::size_t>(found - waypoints_->begin());
  }
  segue::Result<void> go_to(const std::string& name) {
    auto found = find(name);
    if (!found) return std::move(found.error());
    route_.assign(1, *found);
    next_ = 0;
    return {};
  }

  State idle_{*this, "idle"};
  State waiting_{*this, "waiting"};
  State moving_{*this, "moving"};
  State reached_{*this, "reached"};
  JointInput joints_{*this};
  OutputPort<messages::JointCommand> command_out_{*this, "command", {.doc = "positions"}};
  Property<std::vector<Waypoint>> waypoints_{*this, "waypoints", {}, {.doc = "configurations by name"}};
  Property<std::vector<std::string>> sequence_{
      *this, "sequence", {}, {.doc = "names of the waypoints to be passed after each start"}};
  Property<double> tolerance_{
      *this,
      "tolerance",
      0.01,
      {.live = true, .doc = "rad or m; distance of each joint at which one is reached"}};
  Property<std::chrono::milliseconds> timeout_{
      *this,
      "timeout",
      std::chrono::milliseconds(500),
      {.live = true, .doc = "waits where joints are older than this"}};
  Operation<segue::Result<void>(std::string)> go_to_{
      *this,
      "go_to",
      {"name"},
      [this](const std::string& name) { return go_to(name); },
      RunsIn::TaskThread,
      "goes to this waypoint instead, until the task is configured again"};

  messages::JointCommand command_;
  std::vector<std::size_t> route_;  ///< indices of waypoints
  std::size_t next_ = 0;            ///< index into route_; its size: all have been reached
};

}  // namespace manipulation

SEGUE_COMPONENT(manipulation::JointWaypoints)
