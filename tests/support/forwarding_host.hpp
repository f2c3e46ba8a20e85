// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_host/task_host.hpp>

#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::testing {

/// Forwards everything to another host; tests override the functions that they disturb. Executes each action
/// as a batch of one.
class ForwardingHost : public task_host::TaskHost {
 public:
  explicit ForwardingHost(task_host::TaskHost& inner) : inner_(inner) {}

  Result<void> perform(const model::Action& action, TimePoint deadline) override {
    return std::move(perform_all({&action, 1}, deadline).front());
  }
  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override {
    inner_.begin_all(std::move(actions), deadline, std::move(completed));
  }
  [[nodiscard]] bool side_by_side() const override { return inner_.side_by_side(); }
  void withdraw() override { inner_.withdraw(); }

  [[nodiscard]] bool stands_in(const model::ComponentName& component) const override {
    return inner_.stands_in(component);
  }
  Result<void> can_make(const model::ComponentName& name) const override { return inner_.can_make(name); }
  [[nodiscard]] Diagnostics check(const model::Network& network) const override {
    return inner_.check(network);
  }
  void expect(const model::Network& target) override { inner_.expect(target); }
  void begin_transition(const model::Network& before, const model::Network& target) override {
    inner_.begin_transition(before, target);
  }
  void get_ready(const model::Network& target) override { inner_.get_ready(target); }
  Result<void> arm_commit(const model::Transition& transition, TimePoint deadline) override {
    return inner_.arm_commit(transition, deadline);
  }
  Result<void> commit() override { return inner_.commit(); }
  void conclude(const model::Transition& transition) override { inner_.conclude(transition); }
  [[nodiscard]] model::Network observe() const override { return inner_.observe(); }
  [[nodiscard]] std::vector<task_host::TaskReport> tasks() const override { return inner_.tasks(); }
  [[nodiscard]] std::vector<task_host::ConnectionReport> connections() const override {
    return inner_.connections();
  }
  Result<model::ComponentModel> describe(const model::TaskId& task) const override {
    return inner_.describe(task);
  }
  Result<type::Value> properties(const model::TaskId& task) const override { return inner_.properties(task); }
  void watch(const task_host::LevelQuestion& question, const Wait& wait,
             task_host::LevelAnswer answered) override {
    inner_.watch(question, wait, std::move(answered));
  }
  Result<task_host::TaskDetails> details(const model::TaskId& task) const override {
    return inner_.details(task);
  }
  Result<void> set_property(const model::TaskId& task, std::string_view path, const type::Value& value,
                            TimePoint deadline) override {
    return inner_.set_property(task, path, value, deadline);
  }
  Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                           const type::Value& arguments, TimePoint deadline) override {
    return inner_.call(task, operation, arguments, deadline);
  }
  Result<void> write(const model::PortRef& port, const type::Value& value, TimePoint deadline) override {
    return inner_.write(port, value, deadline);
  }
  Result<std::unique_ptr<task_host::PortReader>> open_reader(const model::PortRef& port,
                                                             std::size_t buffer) override {
    return inner_.open_reader(port, buffer);
  }
  void set_listener(Listener listener) override { inner_.set_listener(std::move(listener)); }

 protected:
  task_host::TaskHost& inner_;
};

}  // namespace segue::testing
