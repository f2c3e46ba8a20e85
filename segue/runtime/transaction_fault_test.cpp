// SPDX-License-Identifier: Apache-2.0
//
// Injects faults at every action of many transitions. Afterwards the robot runs the old network or the new
// one, or the runtime reports correctly what runs.
#include <segue/model/network_sets.hpp>
#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/test_support.hpp>

#include <support/faulty_host.hpp>
#include <support/paths.hpp>
#include <support/random_networks.hpp>
#include <support/sanitizers.hpp>

#include <gmock/gmock.h>

#include <cstdlib>
#include <set>
#include <tuple>

namespace segue::runtime {
namespace {

using segue::testing::Fault;
using segue::testing::FaultyHost;
using segue::testing::kFaultNames;
using segue::testing::kFaults;
using testing::runnable;

const std::string kArtemis = segue::paths::in_sources("/examples/04_artemis/robot.yaml");

/// A runtime whose tasks are all stand-ins, and whose host may fail.
struct FaultyRobot {
  model::ComponentCatalog catalog;
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost tasks{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  FaultyHost host{tasks};
  Runtime runtime{"robot", host, catalog};
};

/// Counts of the three allowed outcomes.
struct Ends {
  int target = 0;
  int before = 0;
  int reported = 0;
  [[nodiscard]] int all() const { return target + before + reported; }
};

/// A transition and the fault at one of its actions.
struct Case {
  const model::Network& before;
  const model::Network& target;
  const model::Transition& plan;
  const model::Action& action;
  Fault fault;
};

std::set<model::TaskId> tasks_of(const std::vector<model::Action>& actions) {
  std::set<model::TaskId> tasks;
  for (const auto& action : actions) {
    if (action.task() != nullptr) {
      tasks.insert(*action.task());
    }
  }
  return tasks;
}

std::set<model::DeploymentKey> processes_of(const std::vector<model::Action>& actions) {
  std::set<model::DeploymentKey> processes;
  for (const auto& action : actions) {
    if (const auto* what = std::get_if<model::DeploymentAction>(&action.what)) {
      processes.insert(what->deployment.key());
    }
  }
  return processes;
}

model::DeploymentKey process_of(const model::Network& network, const model::TaskId& task) {
  for (const auto& deployment : network.deployments) {
    for (const auto& placement : deployment.tasks) {
      if (placement.task == task) {
        return deployment.key();
      }
    }
  }
  return {};
}

/// Tasks and processes without an action in the transition were not touched, by undoing neither.
void expect_others_untouched(const Case& what, const FaultyHost& host) {
  const auto passed = host.passed();
  const auto touched = tasks_of(passed);
  const auto ended = processes_of(passed);
  const auto planned_tasks = tasks_of(what.plan.actions);
  const auto planned_processes = processes_of(what.plan.actions);
  const bool in_prepare = what.action.phase == model::Phase::Prepare;
  for (const auto& deployment : what.before.deployments) {
    const auto key = deployment.key();
    const bool concerned = key == host.place() || (planned_processes.contains(key) && !in_prepare);
    EXPECT_TRUE(concerned || !ended.contains(key)) << "process " << to_string(key);
  }
  for (const auto& task : what.before.tasks) {
    const bool planned = planned_tasks.contains(task.id) && !in_prepare;
    const auto process = process_of(what.before, task.id);
    const bool process_went = !process.is_runtime() && (ended.contains(process) || host.place() == process);
    EXPECT_TRUE(planned || process_went || !touched.contains(task.id)) << "task " << task.id.str();
  }
}

/// The old network runs exactly as before, and nothing else runs.
void expect_restored(const Case& what, const Runtime& runtime, const model::Network& observed) {
  EXPECT_EQ(runtime.belief().name, what.before.name);
  EXPECT_TRUE(model::includes(observed, what.before))
      << ::testing::PrintToString(differences(what.before, observed));
  for (const auto& task : what.before.tasks) {
    const auto* now = observed.find_task(task.id);
    ASSERT_NE(now, nullptr) << task.id.str();
    EXPECT_EQ(*now, task) << task.id.str();
  }
  for (const auto& task : model::subtract(observed, what.before).tasks) {
    EXPECT_NE(task.state, TaskState::Running) << task.id.str() << " runs beside the restored network";
  }
  for (const auto& connection : model::subtract(observed, what.before).connections) {
    const bool among_them = what.before.find_task(connection.from.task) != nullptr &&
                            what.before.find_task(connection.to.task) != nullptr;
    EXPECT_FALSE(among_them) << to_string(connection) << " in the restored network";
  }
}

std::vector<Event> reported_differences(const Runtime& runtime, std::uint64_t since) {
  auto events = runtime.events(since);
  std::erase_if(events, [](const Event& event) { return event.kind != EventKind::Difference; });
  return events;
}

/// `since` is the number of the last event before the switch.
void check_outcome(const Case& what, const Runtime& runtime, const FaultyHost& host,
                   const SwitchResult& result, std::uint64_t since, Ends& ends) {
  const model::Network observed = host.observe();
  if (result.outcome == Outcome::Done) {
    ++ends.target;
    EXPECT_EQ(runtime.belief().name, what.target.name);
    if (!result.leftover) {
      EXPECT_THAT(differences(what.target, observed), ::testing::IsEmpty());
    } else if (!model::includes(observed, what.target)) {
      EXPECT_FALSE(reported_differences(runtime, since).empty()) << "missing parts are reported";
    }
  } else if (result.undo && result.undo->restored) {
    ++ends.before;
    expect_restored(what, runtime, observed);
    expect_others_untouched(what, host);
  } else {
    ++ends.reported;
    EXPECT_EQ(runtime.state(), RuntimeState::Failed);
    EXPECT_THAT(result.why(), ::testing::HasSubstr("the robot now runs"));
    EXPECT_THAT(differences(runtime.belief(), observed), ::testing::IsEmpty());
  }
}

/// Executes the transition with that fault at that action, then switches back to the old network.
void try_fault(FaultyRobot& robot, const Case& what, Ends& ends) {
  SCOPED_TRACE(what.before.name.str() + " to " + what.target.name.str() + ": " + what.action.label() + " (" +
               std::string(to_string(what.action.phase)) + "), " +
               std::string(kFaultNames.at(static_cast<std::size_t>(what.fault))));
  const auto events = robot.runtime.events();
  robot.host.arm(what.fault, what.action.label());
  const auto result = robot.runtime.switch_to(what.target);
  EXPECT_TRUE(robot.host.struck());
  check_outcome(what, robot.runtime, robot.host, result, events.empty() ? 0 : events.back().number, ends);
  robot.host.heal();
  const auto back = robot.runtime.switch_to(what.before);
  ASSERT_EQ(back.outcome, Outcome::Done) << back.why();
  ASSERT_THAT(differences(what.before, robot.host.observe()), ::testing::IsEmpty());
}

/// Whether every fault is injected at every action, which takes minutes.
bool thorough() {
  return std::getenv("SEGUE_ALL_FAULTS") != nullptr;
}

/// Sanitizers make everything many times slower.
constexpr int kRandomCases = kSanitized ? 100 : 1500;

/// Selects the faults for an action: all, or a sample in which every action has one and each fault occurs at
/// every kind of action in every phase. Under sanitizers only one occurs there: transitions of small random
/// networks, where all occur, run the same code.
class Sample {
 public:
  bool takes(const model::Action& action, Fault fault) {
    const auto number = static_cast<std::size_t>(fault);
    if (number == 0) {
      ++turn_;
    }
    if (thorough()) {
      return true;
    }
    if (kSanitized) {
      return number == (kinds_.size() + 1) % kFaults.size() &&
             kinds_.emplace(action.kind, action.phase).second;
    }
    const bool is_new = seen_.emplace(action.kind, action.phase, fault).second;
    return is_new || turn_ % kFaults.size() == number;
  }

 private:
  std::size_t turn_ = 0;
  std::set<std::pair<model::ActionKind, model::Phase>> kinds_;
  std::set<std::tuple<model::ActionKind, model::Phase, Fault>> seen_;
};

/// Injects every fault at every action of the transition between two networks.
void try_all_faults(const model::Network& before, const model::Network& target, Ends& ends) {
  FaultyRobot robot;
  ASSERT_EQ(robot.runtime.switch_to(before).outcome, Outcome::Done);
  const auto plan = robot.runtime.plan(target);
  ASSERT_TRUE(plan);
  for (const auto& action : plan->actions) {
    for (const Fault fault : kFaults) {
      ASSERT_NO_FATAL_FAILURE(try_fault(robot, {before, target, *plan, action, fault}, ends));
    }
  }
}

/// The runtime's own process cannot be replaced; everything else is undone.
TEST(TransactionFaults, OfTasksInTheProcessOfTheRuntime) {
  const auto before = testing::network_of("network: before\ntasks: {a: {component: \"demo::A\"}}\n");
  const auto target = testing::network_of(
      "network: target\n"
      "tasks: {a: {component: \"demo::A\"}, b: {component: \"demo::B\"}, c: {component: \"demo::B\"}}\n"
      "connections: [b.out -> a.in, c.out -> a.in, a.out -> a.back, a.out -> b.in]\n");
  Ends ends;
  try_all_faults(before, target, ends);
  EXPECT_GT(ends.before, 10);
}

/// Tasks that leave without an action still exist after a failed transition.
TEST(TransactionFaults, WhereTasksThatWereNeverConfiguredLeave) {
  const auto before = testing::network_of(
      "network: before\n"
      "tasks: {a: {component: \"demo::A\"}, b: {component: \"demo::A\"},"
      " idle: {component: \"demo::B\", state: pre_operational}}\n"
      "deployments: {one: {tasks: [a]}, two: {tasks: [b, idle]}}\n"
      "connections: [idle.out -> a.in]\n");
  const auto target = testing::network_of(
      "network: target\n"
      "tasks: {a: {component: \"demo::A\", properties: {gain: 2}}, b: {component: \"demo::A\"}}\n"
      "deployments: {one: {tasks: [a]}, two: {tasks: [b]}}\n");
  Ends ends;
  try_all_faults(before, target, ends);
  EXPECT_GT(ends.before, 10);
}

TEST(TransactionFaults, AtEveryActionOfTheArtemisTransitions) {
  auto example = EmbeddedRobot::open(kArtemis, {.stand_in = true});
  ASSERT_TRUE(example) << to_string(diagnostics_of(example.error()));
  Ends ends;
  Sample sample;
  for (const auto& from : example->runtime().controllers()) {
    FaultyRobot robot;
    const auto before = *example->runtime().controller(from);
    ASSERT_EQ(robot.runtime.switch_to(before).outcome, Outcome::Done);
    for (const auto& to : example->runtime().controllers()) {
      if (from == to) {
        continue;
      }
      const auto target = *example->runtime().controller(to);
      const auto plan = robot.runtime.plan(target);
      ASSERT_TRUE(plan);
      for (const auto& action : plan->actions) {
        for (const Fault fault : kFaults) {
          if (sample.takes(action, fault)) {
            ASSERT_NO_FATAL_FAILURE(try_fault(robot, {before, target, *plan, action, fault}, ends));
          }
        }
      }
    }
  }
  EXPECT_GT(ends.target, kSanitized ? 1 : 20);
  EXPECT_GT(ends.before, kSanitized ? 1 : 50);
  RecordProperty("cases", ends.all());
}

TEST(TransactionFaults, AtEveryActionOfRandomTransitions) {
  segue::testing::NetworkShape shape;
  shape.attributes = false;
  segue::testing::Random random(20261122);
  Ends ends;
  for (int pair = 0; ends.all() < (thorough() ? 100'000 : kRandomCases); ++pair) {
    auto before = runnable(segue::testing::random_network(random, shape));
    auto target = runnable(segue::testing::random_variation(random, before, shape));
    before.name = model::NetworkName("before" + std::to_string(pair));
    target.name = model::NetworkName("target" + std::to_string(pair));
    ASSERT_NO_FATAL_FAILURE(try_all_faults(before, target, ends));
  }
  EXPECT_GT(ends.target, kRandomCases / 15);
  EXPECT_GT(ends.before, kRandomCases / 15);
  EXPECT_GT(ends.reported, kRandomCases / 150);
}

}  // namespace
}  // namespace segue::runtime
