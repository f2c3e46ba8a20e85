// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/distributed/distributed_task_host.hpp>

#include <segue/base/text.hpp>
#include <segue/distributed/lease.hpp>
#include <segue/solve/solve.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/early_end.hpp>
#include <segue/task_host/full_id.hpp>
#include <segue/task_host/local_task_host.hpp>
#include <support/eventually.hpp>
#include <support/fake_hosts.hpp>
#include <support/network_of.hpp>
#include <support/random_networks.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <future>
#include <random>
#include <thread>

namespace segue::distributed {

using namespace std::chrono_literals;
using model::HostName;
using model::Order;
using model::Phase;
using model::TaskId;
using segue::testing::eventually;
using segue::testing::kPatience;
using segue::testing::network_of;

inline TimePoint later(Duration duration = 30s) {
  return RealClock::instance().now() + duration;
}

const char* const kFirst = R"(network: first
tasks:
  a: {component: test::A}
  b: {component: test::B}
  c: {component: test::C}
  d: {component: test::D}
deployments:
  p1: {process: p1, host: left, tasks: [a, b]}
  p2: {process: p2, host: right, tasks: [c]}
connections:
  - a.out -> b.in
  - a.out -> c.in
  - {from: b.out, to: c.more, policy: buffer, size: 10}
  - c.out -> d.in
  - d.out -> a.in
  - d.out -> c.again
)";

/// b has moved from left to right, c from right to the runtime's own process; e is new, and d reads more.
const char* const kSecond = R"(network: second
tasks:
  a: {component: test::A}
  b: {component: test::B, takes_over: b}
  c: {component: test::C, state: stopped}
  d: {component: test::D}
  e: {component: test::E}
deployments:
  p1: {process: p1, host: left, tasks: [a]}
  p3: {process: p3, host: right, tasks: [b, e]}
  p4: {process: p4, host: workstation, tasks: [d]}
connections:
  - a.out -> b.in
  - a.out -> d.in
  - b.out -> c.in
  - c.out -> e.in
  - d.out -> a.in
)";

inline std::string said(const Result<void>& result) {
  return result ? "done" : to_string(result.error());
}

/// The computers of a robot: its runtime's own, "left" and "right".
struct Computers {
  deploy::testing::FakeWorld own;
  testing::Computer left{"left"};
  testing::Computer right{"right"};
};

/// A runtime's host over all of them. Nothing is watched unless the test wishes it.
struct Commander {
  explicit Commander(Computers& all, DistributedOptions chosen = {}, Duration watch = 1h,
                     const std::string& holder = "me", model::ComponentCatalog known = {})
      : computers(all), catalog(std::move(known)), options(complete(std::move(chosen), watch, holder)) {
    host.set_listener([this](const task_host::HostEvent& event) {
      if (const auto* computer = std::get_if<task_host::ComputerEvent>(&event)) {
        note(computer->host.str() + (computer->reachable ? " is back" : " is lost"));
      }
      if (std::holds_alternative<task_host::LossEvent>(event)) {
        note("the robot is lost");
      }
    });
  }
  ~Commander() { host.set_listener({}); }

  void note(std::string event) {
    const Lock lock(mutex);
    events.push_back(std::move(event));
    changed.notify_all();
  }

  static DistributedOptions complete(DistributedOptions options, Duration watch, const std::string& holder) {
    const bool take_over = options.request.take_over;
    options.request = testing::request_of(holder, take_over);
    options.gateways.robot = "robot";
    options.gateways.own = {HostName("workstation")};
    options.watch = watch;
    return options;
  }

  /// Switches in the steps in which the runtime does.
  Result<void> switch_to(const model::Network& network) {
    const model::Network observed = host.observe();
    const model::Network target = host.expanded(network);
    const auto transition = plan(observed, target);
    host.begin_transition(observed, target);
    auto done = perform(transition, Phase::Prepare);
    if (done) {
      host.get_ready(target);
      done = host.arm_commit(transition, later());
    }
    if (done) {
      done = perform(transition, Phase::Commit);
    }
    if (done) {
      done = host.commit();
    }
    if (!done) {
      host.withdraw();
      return done;
    }
    done = perform(transition, Phase::Retire);
    host.conclude(transition);
    return done;
  }
  Result<void> switch_to(const char* text) { return switch_to(network_of(text)); }

  [[nodiscard]] model::Transition plan(const model::Network& observed, const model::Network& target) const {
    const auto transition = solve::diff(observed, target, catalog, {order, host.side_by_side()});
    EXPECT_TRUE(transition) << to_string(transition.error());
    return transition.value_or(model::Transition{});
  }
  Result<void> perform(const model::Transition& transition, Phase phase) {
    std::vector<model::Action> actions;
    for (const auto& action : transition.actions) {
      if (action.phase == phase) {
        actions.push_back(action);
      }
    }
    Result<void> outcome;
    std::size_t reported = 0;
    const std::size_t count = actions.size();
    host.perform_in_order(std::move(actions), 60s, {}, [&](std::vector<task_host::Completed> ended) {
      for (auto& one : ended) {
        ++reported;
        if (outcome && one.begun) {
          outcome = std::move(one.outcome);
        }
      }
    });
    EXPECT_EQ(reported, count);
    return outcome;
  }

  [[nodiscard]] std::string wrong(const model::Network& shall) const {
    return listed(model::differences(host.expanded(shall), host.observe()));
  }
  [[nodiscard]] std::string wrong(const char* shall) const { return wrong(network_of(shall)); }
  [[nodiscard]] task_host::ComputerReport computer(const std::string& name) const {
    for (auto& report : host.computers()) {
      if (report.name.str() == name) {
        return report;
      }
    }
    return {};
  }
  bool told(const std::string& event) {
    Lock lock(mutex);
    return changed.wait_for(mutex, kPatience,
                            [&] { return std::find(events.begin(), events.end(), event) != events.end(); });
  }

  Computers& computers;
  const model::ComponentCatalog catalog;
  const DistributedOptions options;
  Order order = Order::Seamless;
  Mutex mutex;                ///< protects both below
  ConditionVariable changed;  ///< `events`
  std::vector<std::string> events;
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost local{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  deploy::testing::FakeProcesses processes{computers.own};
  deploy::testing::FakeService service{computers.own, computers.own.own()};
  fleet::DeployedTaskHost own{service,
                              processes,
                              deploy::testing::connector(computers.own),
                              testing::request_of("").launch,
                              local,
                              {60s, 1h, {model::kLocalHost, HostName("workstation")}}};
  DistributedTaskHost host{own, {computers.left.place(), computers.right.place(true)}, catalog, options};
};

inline model::Network none() {
  return {};
}

}  // namespace segue::distributed
