// SPDX-License-Identifier: Apache-2.0
// A component with states of its own: two of running, and one of an error that it recovers from by itself.
#include <segue/task/component.hpp>

#include <chrono>

namespace states {

using namespace segue::task;

/// Follows a beacon. Without a signal it cannot: it waits in the error state until the signal is back.
class Tracker final : public Component {
 public:
  Tracker()
      : Component({.doc = "Follows a beacon", .activity = segue::periodic(std::chrono::milliseconds(10))}) {}

 private:
  segue::Result<void> on_start() override {
    searching_.enter();
    return {};
  }
  void on_update() override {
    if (signal_ <= 0) {
      error(no_signal_, "the antenna receives nothing");  // from now on on_error() is called instead
    } else {
      (signal_ >= *threshold_ ? tracking_ : searching_).enter();  // no cost if it is in that state already
    }
  }
  void on_error() override {
    if (signal_ > 0) recovered();
  }

  State searching_{*this, "searching"};
  State tracking_{*this, "tracking"};
  ErrorState no_signal_{*this, "no_signal"};
  Property<double> threshold_{*this, "threshold", 0.5, {.live = true, .doc = "signal at which it tracks"}};
  Operation<void(double)> receive_{*this, "receive", {"signal"}, [this](double signal) { signal_ = signal; }};
  double signal_ = 0.1;
};

}  // namespace states

SEGUE_COMPONENT(states::Tracker)
