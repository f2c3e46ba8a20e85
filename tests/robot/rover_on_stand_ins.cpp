// SPDX-License-Identifier: Apache-2.0
#include "rover_on_stand_ins.hpp"

#include <segue/base/file.hpp>
#include <segue/runtime/event.hpp>
#include <segue/runtime/runtime.hpp>

#include <support/eventually.hpp>
#include <support/paths.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <iterator>
#include <utility>

#include <unistd.h>

namespace segue::testing {

namespace fs = std::filesystem;

namespace {

/// All in one process but for the planners.
void copy_controllers(const fs::path& into) {
  for (const auto& file :
       fs::directory_iterator(segue::paths::in_sources("/examples/08_rover/controllers"))) {
    const auto text = read_file(file.path());
    ASSERT_TRUE(text);
    ASSERT_TRUE(
        write_file(into / file.path().filename(), text->substr(0, text->find("\ndeployments:")) + "\n"));
  }
}

std::string robot_file(Random& random) {
  constexpr std::array kSizes = {"1..3", "1..2", "2..3", "0..3", "2"};
  return fmt::format(
      "robot: rover_of_stand_ins\n"
      "libraries: [segue_components_demo]\n"
      "controllers: [controllers/*.yaml]\n"
      "policies: {{watch: 10ms, restart: {{max: 20, backoff: 1ms}}}}\n"
      "pools:\n"
      "  planner: {{component: \"demo::RoutePlanner\", size: {}, idle_after: {}ms, properties: {{effort: "
      "5ms}}}}\n"
      "  scout: {{component: \"demo::RoutePlanner\", size: 0..2, idle_after: 20ms, properties: {{effort: "
      "2ms}}}}\n",
      kSizes.at(static_cast<std::size_t>(up_to(random, static_cast<int>(kSizes.size()) - 1))),
      1 + up_to(random, 40));
}

}  // namespace

RoverOnStandIns::RoverOnStandIns(Random& random) {
  std::string pattern = ::testing::TempDir() + "segue-rover-XXXXXX";
  EXPECT_NE(::mkdtemp(pattern.data()), nullptr);
  folder_ = pattern;
  ::setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
  ::setenv("SEGUE_LIBRARY_PATH", segue::paths::kComponentFolder, 1);
  ::setenv("SEGUE_DEPLOYMENT", segue::paths::kDeploymentProgram, 1);
  fs::create_directory(folder_ / "controllers");
  copy_controllers(folder_ / "controllers");
  EXPECT_TRUE(write_file(folder_ / "robot.yaml", robot_file(random)));
  EXPECT_TRUE(write_file(folder_ / "stand_ins.yaml", "stand_ins: {default: {rate: 100}}\n"));
  auto robot =
      runtime::EmbeddedRobot::open(folder_ / "robot.yaml", {.stand_in = true,
                                                            .stand_ins = folder_ / "stand_ins.yaml",
                                                            .placement = runtime::TaskPlacement::Processes,
                                                            .log_level = LogLevel::Error});
  EXPECT_TRUE(robot) << to_string(robot.error());
  robot_.emplace(std::move(*robot));
}

RoverOnStandIns::~RoverOnStandIns() {
  const auto ended = robot_->shut_down();
  EXPECT_TRUE(ended.ok()) << ended.why();
  robot_.reset();
  fs::remove_all(folder_);
}

std::string RoverOnStandIns::events() {
  std::string all;
  for (const auto& event : runtime().events())
    all += fmt::format("{} {}: {}\n", to_string(event.kind), event.subject, event.message);
  return all;
}

std::set<std::string> RobotWithKilledPlanners::planners() const {
  const Lock lock(mutex_);
  std::set<std::string> names;
  for (const auto& [planner, pid] : pids_)
    names.insert(planner);
  return names;
}

void RobotWithKilledPlanners::take_instance(const model::InstanceQuestion& what, const Wait& wait,
                                            model::InstanceAnswer answered) {
  inner_->take_instance(what, wait,
                        [this, answered = std::move(answered)](Result<model::TakenInstance> taken) {
                          if (taken) {
                            const Lock lock(mutex_);
                            pids_.insert_or_assign(taken->task, taken->pid);
                          }
                          answered(std::move(taken));
                        });
}

Result<type::Value> RobotWithKilledPlanners::call(const mission::Member& operation,
                                                  const type::Value& arguments, const Wait& wait) {
  if (operation.task == "battery") return type::Value(battery_is_low_.load());
  const Kill how = next_kill();
  if (how == Kill::Before) kill(operation.task);
  if (how == Kill::Another) kill_another(operation.task);
  std::optional<std::jthread> killer;
  if (how == Kill::Meanwhile)
    killer.emplace([&](const std::stop_token& is_over) { kill_at_work(operation.task, is_over); });
  auto answer = inner_->call(operation, arguments, wait);
  if (!answer && !wait.stop.stop_requested()) ++lost_calls_;
  return answer;
}

RobotWithKilledPlanners::Kill RobotWithKilledPlanners::next_kill() {
  const Lock lock(mutex_);
  if (kills_left_ == 0 || !one_in(random_, 2)) return Kill::None;
  --kills_left_;
  constexpr std::array kAll = {Kill::Before, Kill::Meanwhile, Kill::Meanwhile, Kill::Another};
  return kAll.at(static_cast<std::size_t>(up_to(random_, static_cast<int>(kAll.size()) - 1)));
}

void RobotWithKilledPlanners::kill(const std::string& planner) {
  const Lock lock(mutex_);
  const auto found = pids_.find(planner);
  const int pid = found == pids_.end() ? 0 : found->second;
  if (pid > 0 && pid != ::getpid() && ::kill(pid, SIGKILL) == 0) ++kills_;
}

void RobotWithKilledPlanners::kill_another(const std::string& planner) {
  const auto pools = inner_->pools(Wait(TimePoint::max()));
  if (!pools) return;
  std::vector<int> others;
  for (const mission::PoolView& pool : *pools) {
    for (const mission::PoolInstanceView& one : pool.instances) {
      if (one.task != planner && one.pid > 0 && one.pid != ::getpid()) others.push_back(one.pid);
    }
  }
  if (others.empty()) return;
  const Lock lock(mutex_);
  if (::kill(others.at(static_cast<std::size_t>(up_to(random_, static_cast<int>(others.size()) - 1))),
             SIGKILL) == 0)
    ++kills_;
}

void RobotWithKilledPlanners::kill_at_work(const std::string& planner, const std::stop_token& is_over) {
  const auto works = [&] {
    const auto pools = inner_->pools(Wait(TimePoint::max()));
    return is_over.stop_requested() || !pools ||
           std::ranges::any_of(*pools, [&](const mission::PoolView& pool) {
             return std::ranges::any_of(pool.instances, [&](const mission::PoolInstanceView& one) {
               return one.task == planner && one.busy;
             });
           });
  };
  if (eventually(works) && !is_over.stop_requested()) kill(planner);
}

}  // namespace segue::testing
