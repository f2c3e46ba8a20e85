// SPDX-License-Identifier: Apache-2.0
#include "types.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace manipulation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Stands in for a 3D mouse in the hand of an operator.
class ScriptedTwist final : public Component {
 public:
  ScriptedTwist()
      : Component({.doc = "Stands in for a 3D mouse: plays a list of velocities, each for its time",
                   .activity = segue::periodic(std::chrono::milliseconds(20))}) {}

 private:
  segue::Result<void> on_configure() override {
    const bool usable = std::ranges::all_of(*script_, [](const TimedTwist& part) {
      return part.duration >= 0 && std::isfinite(part.duration) && part.twist.linear.allFinite() &&
             part.twist.angular.allFinite();
    });
    if (!usable) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "script must consist of finite velocities with durations that are not negative");
    }
    return {};
  }

  segue::Result<void> on_start() override {
    play();
    return {};
  }

  void on_update() override {
    double elapsed = std::chrono::duration<double>(now() - begin_).count();
    const double length = total();
    if (*repeat_ && length > 0) elapsed = std::fmod(elapsed, length);
    const TimedTwist* current = nullptr;
    for (const TimedTwist& part : *script_) {
      if (elapsed < part.duration) {
        current = &part;
        break;
      }
      elapsed -= part.duration;
    }
    (current != nullptr ? playing_ : done_).enter();
    twist_out_.write(current != nullptr ? current->twist : messages::Twist{});
  }

  void on_stop() override { twist_out_.write({}); }

  [[nodiscard]] double total() const {
    double sum = 0;
    for (const TimedTwist& part : *script_)
      sum += part.duration;
    return sum;
  }
  void play() { begin_ = now(); }

  State playing_{*this, "playing"};
  State done_{*this, "done"};
  OutputPort<messages::Twist> twist_out_{*this, "twist"};
  Property<std::vector<TimedTwist>> script_{
      *this, "script", {}, {.doc = "played from its beginning after each start"}};
  Property<bool> repeat_{*this, "repeat", false, {.doc = "begin again at the end"}};
  Operation<void()> play_{*this, "play", {}, [this] { play(); }, RunsIn::TaskThread, "begins again"};

  segue::TimePoint begin_;
};

}  // namespace manipulation

SEGUE_COMPONENT(manipulation::ScriptedTwist)
