// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/commanded_robot.hpp>

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace segue::mission {

/// A task as a test says that it is; questions wait until it is not as their askers have seen it. Not thread
/// safe.
class FakeTask {
 public:
  TaskView view{"running", "driving", 0};
  bool updates = true;  ///< each question comes after another update

  /// `changes`: of its robot. The answer that is to be given now; nothing: the question waits.
  std::function<void()> watch(const TaskQuestion& question, TaskAnswer answered, std::uint64_t changes) {
    if (updates) ++view.updates;
    if (!question.is_news(view)) {
      waiting_.emplace_back(question, std::move(answered));
      return [] {};
    }
    return [answered = std::move(answered), now = as_of(changes)] { answered(now); };
  }
  void answer_waiting(std::uint64_t changes) {
    std::erase_if(waiting_, [&](const auto& one) {
      if (!one.first.is_news(view)) return false;
      one.second(as_of(changes));
      return true;
    });
  }

 private:
  [[nodiscard]] TaskView as_of(std::uint64_t changes) const {
    TaskView now = view;
    now.changes = changes;
    return now;
  }
  std::vector<std::pair<TaskQuestion, TaskAnswer>> waiting_;
};

}  // namespace segue::mission
