// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_host/task_access.hpp>
#include <segue/task_host/task_forwarder.hpp>
#include <segue/task_host/task_host.hpp>

#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::testing {

/// Forwards everything to another host; tests override the functions that they disturb. Executes each action
/// as a batch of one.
class ForwardingHost : public task_host::TaskForwarder<task_host::TaskHost> {
 public:
  explicit ForwardingHost(task_host::TaskHost& inner) : inner_(inner) {}

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
  void set_listener(Listener listener) override { inner_.set_listener(std::move(listener)); }

 protected:
  [[nodiscard]] Result<task_host::TaskPlace> find_place(const model::TaskId& task,
                                                        task_host::Purpose /*purpose*/) const override {
    return task_host::place_at(inner_, task);
  }

  task_host::TaskHost& inner_;
};

}  // namespace segue::testing
