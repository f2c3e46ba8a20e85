// SPDX-License-Identifier: Apache-2.0
// Two components: one counts, the other doubles each count.
#include <segue/task/component.hpp>

#include <chrono>
#include <cstdint>
#include <string>

namespace hello {

/// The sample type of their connection.
struct Count {
  std::int64_t number = 0;
  std::string unit;
};

SEGUE_TYPE(Count, number, unit)

using namespace segue::task;

class Counter final : public Component {
 public:
  Counter()
      : Component({.doc = "Counts in steps", .activity = segue::periodic(std::chrono::milliseconds(10))}) {}

 private:
  void on_update() override {
    count_.number += *step_;
    out_.write(count_);
  }
  std::int64_t reset() {
    const std::int64_t before = count_.number;
    count_.number = 0;
    return before;
  }

  OutputPort<Count> out_{*this, "count"};
  Property<std::int64_t> step_{*this, "step", 1, {.live = true, .doc = "added at every update"}};
  Operation<std::int64_t()> reset_{*this, "reset", {}, [this] { return reset(); }};
  Count count_{.number = 0, .unit = "ticks"};
};

class Doubler final : public Component {
 public:
  Doubler() : Component({.doc = "Doubles every count"}) {}

 private:
  void on_update() override {  // runs for each new sample, since components are port driven by default
    while (in_.read(count_) == ReadStatus::NewData) {
      count_.number *= 2;
      out_.write(count_);
    }
  }

  InputPort<Count> in_{*this, "count"};
  OutputPort<Count> out_{*this, "doubled"};
  Count count_;
};

}  // namespace hello

SEGUE_COMPONENT(hello::Counter)
SEGUE_COMPONENT(hello::Doubler)
