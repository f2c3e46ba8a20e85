// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_robot/prepared_controllers.hpp>
#include <segue/mission_robot/upcoming_controllers.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace segue::mission {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

constexpr const char* kActions = R"(
mission: m
actions:
  explore: {outcomes: [seen, nothing], expect: {outcome: seen, duration: 20s}, run: {controller: explore}}
  drive: {inputs: {to: text}, expect: {duration: 10s}, run: {controller: 'drive_{to}'}}
  grasp: {outcomes: [holding, lost], run: {controller: grasp}}
  think: {expect: {duration: 1s}, run: {simulated: {duration: 1s}}}
  decide: {outcomes: [ok], run: {decide: [{outcome: ok}]}}
outcomes: [done]
)";

class Upcoming : public ::testing::Test {
 protected:
  void read(const std::string& states) {
    Diagnostics diagnostics;
    auto mission = read_mission(kActions + states, "m.yaml", diagnostics);
    ASSERT_TRUE(mission) << to_string(diagnostics);
    auto program = Program::compile(std::move(*mission));
    ASSERT_TRUE(program) << to_string(program.error());
    program_ = std::move(*program);
  }
  /// "name 0.80 20s"
  std::vector<std::string> after(const std::string& path) const {
    std::vector<std::string> texts;
    for (const auto& one : upcoming_controllers(*program_, state(path))) {
      const int percent = static_cast<int>(one.probability * 100 + 0.5);
      texts.push_back(one.controller + " " + std::to_string(percent) + "% " + format(one.after));
    }
    return texts;
  }

 private:
  static std::string format(Duration after) {
    return std::to_string(std::chrono::duration_cast<std::chrono::seconds>(after).count()) + "s";
  }
  [[nodiscard]] StateIndex state(const std::string& path) const {
    const auto& states = program_->mission().states;
    for (StateIndex i = 0; i < states.size(); ++i) {
      if (program_->mission().path(i) == path) return i;
    }
    ADD_FAILURE() << path;
    return 0;
  }

  std::shared_ptr<const Program> program_;
};

TEST_F(Upcoming, ControllersAreFoundAlongTheExpectedWay) {
  read(R"(
start: look
states:
  look: {action: explore, on: {seen: near, nothing: rest}}
  near: {action: think, on: {success: there}}
  there: {action: drive, inputs: {to: box}, on: {success: take}}
  take: {action: grasp, on: {holding: return done, lost: look}}
  rest: {action: drive, inputs: {to: home}, on: {success: return done}}
)");
  EXPECT_THAT(after("look"),
              ElementsAre("drive_box 100% 21s", "grasp 100% 31s", "explore 62% 31s", "drive_home 31% 20s"));
  EXPECT_THAT(after("rest"), IsEmpty());
}

TEST_F(Upcoming, ControllersWhoseNameIsNotKnownYetAreLeftOut) {
  read(R"(
inputs: {place: {type: text, default: home}}
flows: [inputs.place -> there.to]
start: look
states:
  look: {action: explore, on: {seen: there, nothing: there}}
  there: {action: drive, on: {success: take}}
  take: {action: grasp, on: {holding: return done, lost: return done}}
)");
  EXPECT_THAT(after("look"), ElementsAre("grasp 100% 30s"));
}

TEST_F(Upcoming, ControllersOfParallelStatesAndOfWhatComesAfterThemAreFound) {
  read(R"(
start: look
states:
  look: {action: explore, on: {seen: both, nothing: return done}}
  both:
    kind: barrier
    outcomes: [ok]
    states:
      left: {action: grasp}
      right: {action: drive, inputs: {to: table}}
      join: {kind: decider, action: decide, on: {ok: return ok}}
    on: {ok: rest}
  rest: {action: drive, inputs: {to: home}, on: {success: return done}}
)");
  EXPECT_THAT(after("look"),
              UnorderedElementsAre("drive_table 80% 20s", "grasp 80% 20s", "drive_home 80% 20s"));
  EXPECT_THAT(after("both/left"), ElementsAre("drive_home 100% 0s"));
}

TEST_F(Upcoming, LoopsEnd) {
  read(R"(
start: left
states:
  left: {action: think, on: {success: right}}
  right: {action: think, on: {success: left}}
)");
  EXPECT_THAT(after("left"), IsEmpty());
}

/// Notes what it is asked to prepare.
class PreparingRobot final : public CommandedRobot {
 public:
  Result<void> request(const ControllerRequest& /*what*/, const Wait& /*wait*/) override { return {}; }
  Result<ControllerTrouble> trouble(std::string_view /*controller*/, const Wait& /*wait*/) override {
    return ControllerTrouble{};
  }
  Result<ControllerConflicts> conflicts(const Wait& /*wait*/) override { return ControllerConflicts{}; }
  Result<void> prepare(const std::vector<std::string>& controllers, const Wait& /*wait*/) override {
    const Lock lock(mutex_);
    prepared_.push_back(controllers);
    changed_.notify_all();
    return fail(ErrorCode::Unsupported, "which harms nobody");
  }
  Result<type::Value> call(const Member& /*operation*/, const type::Value& /*arguments*/,
                           const Wait& /*wait*/) override {
    return type::Value();
  }
  Result<void> set(const Member& /*property*/, const type::Value& /*value*/, const Wait& /*wait*/) override {
    return {};
  }
  Result<void> write(const Member& /*port*/, const type::Value& /*value*/, const Wait& /*wait*/) override {
    return {};
  }
  void watch(const TaskQuestion& /*question*/, const Wait& /*wait*/, TaskAnswer answered) override {
    answered(TaskView{});
  }
  void changes(std::uint64_t seen, const Wait& /*wait*/, ChangesAnswer answered) override {
    if (seen == 0) answered(1);
  }
  Result<std::unique_ptr<PortSamples>> open(const Member& /*port*/, const Wait& /*wait*/) override {
    return fail(ErrorCode::Unsupported, "not in this test");
  }
  bool wait_for(const std::vector<std::string>& controllers) {
    Lock lock(mutex_);
    return changed_.wait_for(mutex_, 60s,
                             [&] { return !prepared_.empty() && prepared_.back() == controllers; });
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  std::vector<std::vector<std::string>> prepared_;
};

TEST(PreparedControllers, AreTheLikeliestOfAllActionsThatRun) {
  const auto robot = std::make_shared<PreparingRobot>();
  {
    PreparedControllers prepared(robot, 2, 1s);
    prepared.began(1, "explore", {{"drive", 0.8, 5s}, {"grasp", 0.5, 9s}, {"rest", 0.2, 1s}});
    EXPECT_TRUE(robot->wait_for({"drive", "grasp"}));
    prepared.began(2, "drive", {{"rest", 0.9, 20s}, {"explore", 0.9, 2s}});
    EXPECT_TRUE(robot->wait_for({"rest", "grasp"})) << "none that runs";
    prepared.ended(1);
    prepared.ended(2);
    prepared.began(3, "grasp", {{"explore", 0.9, 3s}});
    EXPECT_TRUE(robot->wait_for({"explore"}));
  }
  EXPECT_TRUE(robot->wait_for({})) << "in the end none is kept";
}

}  // namespace
}  // namespace segue::mission
