// SPDX-License-Identifier: Apache-2.0
#include <segue/hosts/task_host_part.hpp>

#include <segue/base/text.hpp>

namespace segue::hosts {

Result<HostView> TaskHostPart::look() {
  return tasks_.look();
}

Result<void> TaskHostPart::expect(const model::Network& target) {
  tasks_.expect(target);
  return {};
}

Result<void> TaskHostPart::begin_transition(const model::Network& before, const model::Network& target) {
  tasks_.begin_transition(before, target);
  return {};
}

Result<void> TaskHostPart::get_ready(const model::Network& target) {
  tasks_.get_ready(target);
  return {};
}

Result<void> TaskHostPart::arm_commit(const model::Transition& transition, std::uint64_t number,
                                      TimePoint deadline) {
  if (auto armed = tasks_.arm_commit(transition, deadline); !armed) {
    return armed;
  }
  const std::lock_guard lock(mutex_);
  armed_ = number;
  promised_ = false;
  return {};
}

Result<void> TaskHostPart::vote(std::uint64_t number, Duration validity) {
  const std::lock_guard lock(mutex_);
  if (number == 0 || number != armed_) {
    return fail(ErrorCode::InvalidState, "transition " + std::to_string(number) + " is not armed here");
  }
  promised_ = true;
  until_ = clock_.now() + validity;
  return {};
}

Result<void> TaskHostPart::commit(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  if (number == 0 || number != armed_ || !promised_) {
    return fail(ErrorCode::InvalidState,
                "transition " + std::to_string(number) + " is not to be committed here");
  }
  promised_ = false;
  armed_ = 0;
  if (const Duration late = clock_.now() - until_; late > Duration(0)) {
    return fail(ErrorCode::InvalidState, "the order to commit transition " + std::to_string(number) +
                                             " came " + format_duration(late) + " too late");
  }
  return tasks_.commit();
}

Result<void> TaskHostPart::conclude(const model::Transition& transition) {
  tasks_.conclude(transition);
  return {};
}

Result<void> TaskHostPart::withdraw() {
  {
    const std::lock_guard lock(mutex_);
    armed_ = 0;
    promised_ = false;
  }
  tasks_.withdraw();
  return {};
}

Result<void> TaskHostPart::end_processes(TimePoint deadline) {
  tasks_.end_processes(deadline);
  return {};
}

void TaskHostPart::set_listener(host::TaskHost::Listener listener) {
  tasks_.set_listener(std::move(listener));
}

void TaskHostPart::begin_all(std::vector<model::Action> actions, TimePoint deadline,
                             host::Completion completed) {
  tasks_.begin_all(std::move(actions), deadline, std::move(completed));
}

Result<std::optional<task::SavedState>> TaskHostPart::save_state(const model::TaskId& task,
                                                                 TimePoint deadline) {
  return tasks_.save_state(task, deadline);
}

Result<void> TaskHostPart::restore_state(const model::TaskId& task, const task::SavedState& state,
                                         TimePoint deadline) {
  return tasks_.restore_state(task, state, deadline);
}

Result<model::ComponentModel> TaskHostPart::describe(const model::TaskId& task) {
  return tasks_.describe(task);
}

Result<type::Value> TaskHostPart::properties(const model::TaskId& task) {
  return tasks_.properties(task);
}

Result<void> TaskHostPart::set_property(const model::TaskId& task, std::string_view path,
                                        const type::Value& value, TimePoint deadline) {
  return tasks_.set_property(task, path, value, deadline);
}

Result<type::Value> TaskHostPart::call(const model::TaskId& task, std::string_view operation,
                                       const type::Value& arguments, TimePoint deadline) {
  return tasks_.call(task, operation, arguments, deadline);
}

Result<std::unique_ptr<host::PortReader>> TaskHostPart::open_reader(const model::PortRef& port,
                                                                    std::size_t buffer) {
  return tasks_.open_reader(port, buffer);
}

}  // namespace segue::hosts
