// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/model/transition.hpp>
#include <segue/task_host/task_access.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

namespace segue::task_host {

/// The purpose of a call, where it decides who may make it or which incarnation of a task it means.
enum class Purpose : std::uint8_t {
  Observe,
  Change,
  Restore  ///< gives a task the state of another one: of incarnations, the next one is meant
};

/// The place of a task.
struct TaskPlace {
  std::shared_ptr<TaskAccess> tasks;  ///< never null; also keeps what has to last as long as the call
  model::TaskId task;                 ///< its id there
};

/// A place that `tasks`, which must outlive it, gives access to.
inline TaskPlace place_at(TaskAccess& tasks, const model::TaskId& task) {
  return {{std::shared_ptr<void>(), &tasks}, task};
}

/// Moves the state of a task, if it has any, to a task of another place. Blocks until the deadline at most.
Result<void> hand_over_state(const TaskPlace& from, const TaskPlace& to, TimePoint deadline);

/// Carries out every verb on a task by handing it to the place of the task, as find_place() says. An error of
/// find_place() that does not say what it is about is about the task. `Interface` is a TaskAccess, whose
/// other functions derived classes have.
template <class Interface>
class TaskForwarder : public Interface {
 public:
  Result<std::optional<task::SavedState>> save_state(const model::TaskId& task, TimePoint deadline) override {
    return hand_over(task, Purpose::Change,
                     [&](const TaskPlace& at) { return at.tasks->save_state(at.task, deadline); });
  }
  Result<void> restore_state(const model::TaskId& task, const task::SavedState& state,
                             TimePoint deadline) override {
    return hand_over(task, Purpose::Restore,
                     [&](const TaskPlace& at) { return at.tasks->restore_state(at.task, state, deadline); });
  }
  Result<model::ComponentModel> describe(const model::TaskId& task) const override {
    return hand_over(task, Purpose::Observe, [](const TaskPlace& at) { return at.tasks->describe(at.task); });
  }
  Result<type::Value> properties(const model::TaskId& task) const override {
    return hand_over(task, Purpose::Observe,
                     [](const TaskPlace& at) { return at.tasks->properties(at.task); });
  }
  Result<TaskDetails> details(const model::TaskId& task) const override {
    return hand_over(task, Purpose::Observe, [](const TaskPlace& at) { return at.tasks->details(at.task); });
  }
  void watch(const LevelQuestion& question, const Wait& wait, LevelAnswer answered) override {
    const auto asked = hand_over(question.task, Purpose::Observe, [&](const TaskPlace& at) -> Result<void> {
      at.tasks->watch({at.task, question.seen, question.each_update}, wait, answered);
      return {};
    });
    if (!asked) answered(asked.error());
  }
  Result<void> set_property(const model::TaskId& task, std::string_view path, const type::Value& value,
                            TimePoint deadline) override {
    return hand_over(task, Purpose::Change, [&](const TaskPlace& at) {
      return at.tasks->set_property(at.task, path, value, deadline);
    });
  }
  Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                           const type::Value& arguments, TimePoint deadline) override {
    return hand_over(task, Purpose::Change, [&](const TaskPlace& at) {
      return at.tasks->call(at.task, operation, arguments, deadline);
    });
  }
  Result<std::unique_ptr<PortReader>> open_reader(const model::PortRef& port, std::size_t buffer) override {
    return hand_over(port.task, Purpose::Observe, [&](const TaskPlace& at) {
      return at.tasks->open_reader({at.task, port.port}, buffer);
    });
  }
  Result<void> write(const model::PortRef& port, const type::Value& value, TimePoint deadline) override {
    return hand_over(port.task, Purpose::Change, [&](const TaskPlace& at) {
      return at.tasks->write({at.task, port.port}, value, deadline);
    });
  }

 protected:
  [[nodiscard]] virtual Result<TaskPlace> find_place(const model::TaskId& task, Purpose purpose) const = 0;

 private:
  template <class Verb>
  auto hand_over(const model::TaskId& task, Purpose purpose, const Verb& verb) const
      -> decltype(verb(std::declval<const TaskPlace&>())) {
    auto place = find_place(task, purpose);
    if (!place) return std::move(place.error()).about(task.str());
    return verb(*place);
  }
};

}  // namespace segue::task_host
