// SPDX-License-Identifier: Apache-2.0
// Two versions of a component. A task of the second one, or in another process, goes on where the first was.
#include <segue/task/component.hpp>

#include <cstdint>

namespace hand_over {

/// The state that is handed over: any described type.
struct Total {
  std::int64_t sum = 0;
};

}  // namespace hand_over

SEGUE_TYPE(hand_over::Total, sum)

namespace hand_over {

using namespace segue::task;

class Counter : public Component {
 public:
  Counter() : Component({.doc = "Adds up numbers"}) {}

 protected:
  std::int64_t add(std::int64_t number) { return total_.sum += number; }

 private:
  /// Called once this task is stopped; it may be started again if the transition is undone.
  std::optional<SavedState> save_state() override { return make_state(total_); }
  /// Called between on_configure() and on_start() of the task that goes on.
  segue::Result<void> restore_state(const SavedState& state) override {
    const auto total = read_state<Total>(state);  // an error for a type or version that it does not know
    if (!total) return total.error();
    total_ = *total;
    return {};
  }

  Total total_;
  Operation<std::int64_t(std::int64_t)> add_{
      *this, "add", {"number"}, [this](std::int64_t number) { return add(number); }};
};

/// The next version, which can subtract as well.
class BetterCounter final : public Counter {
  Operation<std::int64_t(std::int64_t)> subtract_{
      *this, "subtract", {"number"}, [this](std::int64_t number) { return add(-number); }};
};

}  // namespace hand_over

SEGUE_COMPONENT(hand_over::Counter)
SEGUE_COMPONENT(hand_over::BetterCounter)
