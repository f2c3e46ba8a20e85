// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/fleet/deployed_task_host.hpp>

#include <segue/fleet/process_record.hpp>
#include <segue/solve/solve.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/full_id.hpp>
#include <segue/task_host/local_task_host.hpp>
#include <support/eventually.hpp>
#include <support/fake_world.hpp>
#include <support/network_of.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <latch>
#include <thread>

namespace segue::fleet {

namespace testing = deploy::testing;
using namespace std::chrono_literals;
using deploy::testing::FakePtr;
using deploy::testing::FakeWorld;
using deploy::testing::Fault;
using deploy::testing::FaultKind;
using model::ActionKind;
using segue::testing::eventually;
using segue::testing::network_of;

inline TimePoint soon() {
  return RealClock::instance().now() + 60s;
}

const char* const kOne = R"(network: one
tasks:
  a: {component: test::A}
  b: {component: test::B}
  c: {component: test::C}
  d: {component: test::D}
deployments:
  p1: {process: p1, tasks: [a, b]}
  p2: {process: p2, tasks: [c]}
connections:
  - a.out -> b.in
  - {from: b.out, to: c.in, policy: buffer, size: 10}
  - c.out -> d.in
  - d.out -> a.in
)";

const char* const kTwo = R"(network: two
tasks:
  a: {component: test::A}
  c: {component: test::C, state: stopped}
  d: {component: test::D}
  e: {component: test::E}
deployments:
  p1: {process: p1, tasks: [a, e]}
  p3: {process: p3, tasks: [c]}
connections:
  - a.out -> c.in
  - c.out -> e.in
  - d.out -> a.in
)";

/// Records the events of the host and waits for them.
class EventRecorder {
 public:
  void add(const task_host::HostEvent& event) {
    {
      const Lock lock(mutex_);
      events_.push_back(event);
    }
    changed_.notify_all();
  }
  bool wait(const std::function<bool(const task_host::HostEvent&)>& fits) {
    Lock lock(mutex_);
    return changed_.wait_until(mutex_, soon(),
                               [&] { return std::any_of(events_.begin(), events_.end(), fits); });
  }
  bool process(const std::string& name, const std::string& part, bool gone) {
    return wait([&](const task_host::HostEvent& event) {
      const auto* what = std::get_if<task_host::ProcessEvent>(&event);
      return what != nullptr && what->process.process.str() == name && what->gone == gone &&
             what->message.find(part) != std::string::npos;
    });
  }
  bool task(const std::string& id, TaskState state) {
    return wait([&](const task_host::HostEvent& event) { return says(event, id, state); });
  }
  bool has_seen(const std::string& id, TaskState state) {
    const Lock lock(mutex_);
    return std::any_of(events_.begin(), events_.end(),
                       [&](const task_host::HostEvent& event) { return says(event, id, state); });
  }

 private:
  static bool says(const task_host::HostEvent& event, const std::string& id, TaskState state) {
    const auto* what = std::get_if<task_host::TaskEvent>(&event);
    return what != nullptr && what->task.str() == id && what->state == state;
  }

  Mutex mutex_;
  ConditionVariable changed_;
  std::vector<task_host::HostEvent> events_;
};

/// A host over simulated processes. They are only polled when a test requests it, so that calls can be
/// counted.
struct Robot {
  explicit Robot(FakeWorld& fakes, DeployedOptions options = {60s, 1h})
      : world(fakes), host(own, processes, deploy::testing::connector(world), launch(), local, options) {
    host.set_listener([this](const task_host::HostEvent& event) { recorded.add(event); });
  }

  static process_server::Launch launch() {
    process_server::Launch launch;
    launch.robot = "robot";
    launch.stand_in = true;
    return launch;
  }

  Result<void> switch_to(const char* text, Duration action_deadline = 60s) {
    return switch_to(network_of(text), action_deadline);
  }
  /// Switches as the runtime does, but one action after the other: observes, solves, and carries out the
  /// actions.
  Result<void> switch_to(const model::Network& target, Duration action_deadline = 60s) {
    const model::Network observed = host.observe();
    const auto transition = solve::diff(observed, target, catalog, {order});
    if (!transition) {
      return transition.error();
    }
    host.begin_transition(observed, target);
    auto done = perform(*transition, model::Phase::Prepare, action_deadline);
    if (done) {
      done = host.arm_commit(*transition, RealClock::instance().now() + action_deadline);
    }
    if (done) {
      done = perform(*transition, model::Phase::Commit, action_deadline);
    }
    if (!done) {
      host.withdraw();
      return done;
    }
    if (auto stored = host.commit(); !stored) return stored;
    done = perform(*transition, model::Phase::Retire, action_deadline);
    host.conclude(*transition);
    return done;
  }
  Result<void> perform(const model::Transition& transition, model::Phase phase, Duration action_deadline) {
    for (const auto& action : transition.actions) {
      if (action.phase != phase) {
        continue;
      }
      if (auto done = host.perform(action, RealClock::instance().now() + action_deadline); !done) {
        return done;
      }
    }
    return {};
  }

  [[nodiscard]] std::vector<std::string> wrong() const {
    return model::differences(world.truth(), host.observe());
  }

  FakeWorld& world;
  model::Order order = model::Order::Paper;
  EventRecorder recorded;
  model::ComponentCatalog catalog;
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost local{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  deploy::testing::FakeProcesses processes{world};
  deploy::testing::FakeService own{world, world.own()};
  DeployedTaskHost host;
};

inline std::string text(const Result<void>& result) {
  return result ? "done" : to_string(result.error());
}

inline std::string text(const std::vector<std::string>& sentences) {
  std::string all;
  for (const auto& sentence : sentences) {
    all += sentence + '\n';
  }
  return all;
}

inline model::Action action(ActionKind kind, decltype(model::Action::what) what) {
  return {1, kind, std::move(what), model::Phase::Commit, {}};
}

inline model::Action on_process(ActionKind kind, const std::string& name) {
  model::Deployment deployment;
  deployment.process = model::ProcessName(name);
  return action(kind, model::DeploymentAction{deployment});
}

inline model::Action on_task(ActionKind kind, const char* task) {
  return action(kind, model::TaskAction{model::TaskId(task)});
}

inline model::Action on_wire(ActionKind kind, const model::Connection& connection) {
  return action(kind, model::ConnectionAction{connection});
}

inline model::Connection wire(const char* from, const char* to, Policy policy = {}) {
  model::Connection connection;
  connection.from = {model::TaskId(from), "out"};
  connection.to = {model::TaskId(to), "in"};
  connection.policy = policy;
  return connection;
}

}  // namespace segue::fleet
