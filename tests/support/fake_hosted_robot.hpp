// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/distributed/hosted_robot.hpp>
#include <segue/task_host/task_access.hpp>
#include <segue/task_host/task_forwarder.hpp>
#include <support/fake_deployment.hpp>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace segue::control {

/// Remembers what was asked; tasks are those of a FakeDeployment.
class FakeHostedRobot final : public task_host::TaskForwarder<distributed::HostedRobot> {
 public:
  Gate entered;  ///< a call has begun that blocks
  Gate go_on;
  mutable FakeDeployment tasks;
  std::atomic<bool> blocks{false};      ///< withdraw()
  std::atomic<bool> slow_begin{false};  ///< begin_transition()

  /// Set before and read after calls.
  struct Fields {
    std::vector<std::string> asked;
    std::optional<Error> refusal;
    distributed::HostView view;
    model::Network before;
    model::Network target;
    model::Transition transition;
    std::vector<model::Action> actions;
    std::vector<distributed::LinkWait> links;
    std::uint64_t number = 0;
    Duration duration{0};
  };
  void set(const std::function<void(Fields&)>& change) {
    const Lock lock(mutex_);
    change(fields_);
  }
  Fields fields() {
    const Lock lock(mutex_);
    return fields_;
  }
  void tell(const task_host::HostEvent& event) {
    const Lock lock(listening_);
    if (listener_) listener_(event);
  }
  bool has_listener() {
    const Lock lock(listening_);
    return listener_ != nullptr;
  }

  Result<void> renew() override { return note("renew"); }
  Result<void> release() override { return note("release"); }
  Result<distributed::HostView> snapshot() override {
    if (auto noted = note("snapshot"); !noted) return noted.error();
    return fields().view;
  }
  Result<void> expect(const model::Network& target) override {
    return note("expect", [&](Fields& fields) { fields.target = target; });
  }
  Result<void> begin_transition(const model::Network& before, const model::Network& target) override {
    if (slow_begin) {
      entered.open();
      go_on.wait();
    }
    return note("begin_transition", [&](Fields& fields) {
      fields.before = before;
      fields.target = target;
    });
  }
  void begin_in_order(std::vector<model::Action> actions, Duration action_deadline,
                      task_host::Completion completed) override {
    auto noted = note("begin_in_order", [&](Fields& fields) {
      fields.actions = actions;
      fields.duration = action_deadline;
    });
    std::vector<task_host::Completed> ended;
    for (std::size_t i = 0; i < actions.size(); ++i) {
      task_host::Completed one{i, noted};
      one.span = task_host::Span{std::chrono::milliseconds(i), std::chrono::milliseconds(i + 1)};
      one.begun = i % 2 == 0;
      ended.push_back(std::move(one));
    }
    completed(std::move(ended));
  }
  void begin_no_more() override { (void)note("begin_no_more"); }
  Result<void> get_ready(const model::Network& target, const std::vector<distributed::LinkWait>& links,
                         TimePoint deadline) override {
    return note("get_ready", [&](Fields& fields) {
      fields.target = target;
      fields.links = links;
      fields.duration = deadline - RealClock::instance().now();
    });
  }
  Result<void> arm_commit(const model::Transition& transition, std::uint64_t number,
                          TimePoint deadline) override {
    return note("arm_commit", [&](Fields& fields) {
      fields.transition = transition;
      fields.number = number;
      fields.duration = deadline - RealClock::instance().now();
    });
  }
  Result<void> vote(std::uint64_t number, Duration validity) override {
    return note("vote", [&](Fields& fields) {
      fields.number = number;
      fields.duration = validity;
    });
  }
  Result<void> commit(std::uint64_t number) override {
    return note("commit", [&](Fields& fields) { fields.number = number; });
  }
  Result<void> conclude(const model::Transition& transition) override {
    return note("conclude", [&](Fields& fields) { fields.transition = transition; });
  }
  Result<void> withdraw() override {
    if (blocks) {
      entered.open();
      go_on.wait();
    }
    return note("withdraw");
  }
  Result<void> end_processes(TimePoint deadline) override {
    return note("end_processes",
                [&](Fields& fields) { fields.duration = deadline - RealClock::instance().now(); });
  }
  void set_listener(task_host::TaskHost::Listener listener) override {
    const Lock lock(listening_);
    listener_ = std::move(listener);
  }

  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override {
    tasks.begin_all(std::move(actions), deadline, std::move(completed));
  }

 protected:
  [[nodiscard]] Result<task_host::TaskPlace> find_place(const model::TaskId& task,
                                                        task_host::Purpose /*purpose*/) const override {
    return task_host::place_at(tasks, task);
  }

 private:
  Result<void> note(const std::string& what, const std::function<void(Fields&)>& change = {}) {
    const Lock lock(mutex_);
    fields_.asked.push_back(what);
    if (change) change(fields_);
    if (fields_.refusal) return *fields_.refusal;
    return {};
  }

  Mutex mutex_;
  Fields fields_;
  Mutex listening_;
  task_host::TaskHost::Listener listener_;
};

}  // namespace segue::control
