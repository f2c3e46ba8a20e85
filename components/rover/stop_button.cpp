// SPDX-License-Identifier: Apache-2.0
#include <segue/task/component.hpp>

#include <chrono>

namespace rover {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Stands for a button that latches: it stays pressed until it is released. Whoever reads it decides what to
/// stop.
class StopButton final : public Component {
 public:
  StopButton()
      : Component({.doc = "Stands for a stop button; operations press and release it",
                   .activity = segue::periodic(std::chrono::milliseconds(10))}) {}

 protected:
  void on_update() override {
    (pressed_ ? pressed_state_ : released_).enter();
    pressed_out_.write(pressed_);
  }

 private:
  State released_{*this, "released"};
  State pressed_state_{*this, "pressed"};
  OutputPort<bool> pressed_out_{*this, "pressed"};
  Operation<void()> press_{
      *this, "press", {}, [this] { pressed_ = true; }, RunsIn::TaskThread, "presses the button"};
  Operation<void()> release_{
      *this, "release", {}, [this] { pressed_ = false; }, RunsIn::TaskThread, "releases it again"};
  bool pressed_ = false;
};

}  // namespace rover

SEGUE_COMPONENT(rover::StopButton)
