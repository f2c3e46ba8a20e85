// SPDX-License-Identifier: Apache-2.0
// Random missions on random robots of stand-ins, with a real runtime: what the robot runs is compared with a
// model all along, while its actions fail, and while others ask for the robot and take it over.
#include <segue/base/mutex.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_run/loaded_mission.hpp>
#include <segue/remote_robot/served_robot.hpp>
#include <segue/runtime/runtime_service.hpp>
#include <segue/runtime/served_runtime.hpp>
#include <segue/runtime/test_support.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <list>
#include <map>
#include <thread>

#include "checked_robot.hpp"
#include "random_robot.hpp"

namespace segue::testing {
namespace {

using namespace std::chrono_literals;
using mission::ControllerRequest;
using mission::ControllerTrouble;

/// What a robot may do wrong, to show that it would be noticed.
enum class Defect { None, LosesAController, HidesFailures, HidesTheTakeOver, TakesTheRobotBack };

class DefectiveRobot final : public ForwardingCommandedRobot {
 public:
  DefectiveRobot(control::RobotService& service, std::shared_ptr<mission::CommandedRobot> inner,
                 Defect defect)
      : ForwardingCommandedRobot(std::move(inner)), service_(service), defect_(defect) {}

  Result<void> request(const ControllerRequest& what, const Wait& wait) override {
    ControllerRequest asked = what;
    if (defect_ == Defect::LosesAController && asked.controllers.size() > 1) asked.controllers.pop_back();
    auto outcome = inner_->request(asked, wait);
    if (outcome) return outcome;
    if (defect_ == Defect::HidesFailures) return {};
    if (defect_ != Defect::TakesTheRobotBack) return outcome;
    const auto taken = service_.switch_to(asked.controllers.empty() ? "" : asked.controllers.front(),
                                          {.who = "a thief", .take_over = true}, wait);
    return taken ? Result<void>() : outcome;
  }
  Result<ControllerTrouble> trouble(std::string_view controller, const Wait& wait) override {
    auto trouble = inner_->trouble(controller, wait);
    const bool is_taken = trouble && trouble->why.starts_with("the robot was taken over");
    if (defect_ == Defect::HidesTheTakeOver && is_taken) return ControllerTrouble{};
    return trouble;
  }

 private:
  control::RobotService& service_;
  const Defect defect_;
};

/// What happens to the robot meanwhile.
struct Trouble {
  int fault_in = 0;         ///< one action in so many fails; 0: none
  bool take_over = false;   ///< somebody takes it over
  bool other_asks = false;  ///< somebody asks for it and is refused
};

/// A random mission on a random robot, once.
class RobotRun {
 public:
  RobotRun(std::uint64_t seed, Trouble trouble, Defect defect = Defect::None)
      : random_(seed),
        trouble_(trouble),
        controllers_(random_controllers(random_)),
        mission_(random_robot_mission(random_, controllers_.size())),
        is_concurrent_(one_in(random_, 2)),
        service_(robot_.runtime, nullptr, [] {}) {
    for (const auto& controller : controllers_)
      EXPECT_FALSE(robot_.runtime.add_controller(controller).has_errors());
    served_ = std::make_shared<remote_robot::ServedRobot>(service_, "the mission");
    checked_ = std::make_shared<CheckedRobot>(robot_.runtime, controllers_,
                                              std::make_shared<DefectiveRobot>(service_, served_, defect));
  }

  /// What was wrong; nothing: all was as it must be.
  std::optional<std::string> run() {
    EXPECT_TRUE(served_->take());
    if (trouble_.fault_in > 0) let_actions_fail();
    {
      const std::jthread other([this, seed = random_()] { disturb(seed); });
      carry_out();
      checked_->mission_is_over();
    }
    const std::set<std::string> left = checked_->running();
    const bool was_lost = checked_->is_lost();
    served_.reset();
    if (auto wrong = checked_->problem()) return wrong;
    checked_.reset();
    if (!was_lost && trouble_.fault_in == 0 && mission_.is_a_sequence && !is_concurrent_ &&
        left != left_by_a_sequence()) {
      return "the mission left other controllers running than it should";
    }
    return after_all();
  }
  [[nodiscard]] const std::string& text() const { return mission_.text; }

 private:
  void let_actions_fail() {
    checked_->expect_faults();
    robot_.asking.ask([random = Random(random_()), in = trouble_.fault_in,
                       mutex = std::make_shared<Mutex>()](const model::Action&) mutable -> Result<void> {
      const Lock lock(*mutex);
      if (one_in(random, in)) return fail(ErrorCode::IoError, "a fault");
      return {};
    });
  }

  void carry_out() {
    Diagnostics diagnostics;
    auto mission = mission::read_mission(mission_.text, "random.yaml", diagnostics);
    ASSERT_TRUE(mission) << to_string(diagnostics) << mission_.text;
    const auto conflicts = checked_->conflicts(Wait(TimePoint::max()));
    ASSERT_TRUE(conflicts);
    const auto plan = mission_run::LoadedMission::create(std::move(*mission), &*conflicts);
    ASSERT_TRUE(plan) << to_string(plan.error()) << mission_.text;
    mission_run::RunRequest request;
    if (is_concurrent_) request.mode = mission_run::Concurrent{};
    request.on_event = [this](const mission::StateEvent& event) { note(event); };
    request.runners.set_controllers(
        std::make_shared<mission::ControllerRunner>(checked_, mission::ControllerOptions{.period = 1ms}));
    const auto run = plan->run(request);
    ASSERT_TRUE(run) << to_string(run.error());
    const auto& overview = (*run)->overview();
    const bool is_calm = trouble_.fault_in == 0 && !trouble_.take_over;
    if (!trouble_.take_over && overview.outcome != "done")
      checked_->blame("the mission ended " + overview.outcome);
    if (is_calm && succeeded_ != static_cast<int>(mission_.actions.size()))
      checked_->blame("not every action succeeded");
  }

  /// An action that begins after the robot was taken over cannot succeed.
  void note(const mission::StateEvent& event) {
    if (event.path.ends_with("judge")) return;
    if (event.kind == mission::StateEvent::Kind::Began) {
      began_late_[std::string(event.path)] = checked_->is_lost();
      return;
    }
    if (event.outcome != "done") return;
    ++succeeded_;
    if (began_late_[std::string(event.path)])
      checked_->blame("an action succeeded although the robot had been taken over before it began");
  }

  /// In a thread of its own, at random points of the mission: each action is answered twice at least.
  void disturb(std::uint64_t seed) {
    Random random(seed);
    int answers = 0;
    const auto wait = [&] {
      answers += up_to(random, static_cast<int>(mission_.actions.size()) + 1);
      checked_->await_answers(answers);
    };
    const auto any = [&] { return any_of(random, controllers_).name.str(); };
    for (int i = up_to(random, 2); trouble_.other_asks && i >= 0; --i) {
      wait();
      const auto answer = service_.switch_to(any(), {.who = "a bystander"}, soon());
      if (answer && answer->find("outcome")->as_string() == "done")
        checked_->blame("a bystander got the robot");
    }
    if (!trouble_.take_over) return;
    wait();
    taker_wants_ = any();
    checked_->about_to_be_taken_over();
    static_cast<void>(service_.switch_to(taker_wants_, {.who = "an operator", .take_over = true}, soon()));
  }
  static TimePoint soon() { return RealClock::instance().now() + 60s; }

  /// What a sequence leaves running, by the rules of the manual.
  std::set<std::string> left_by_a_sequence() {
    const auto conflicts =
        remote_robot::ServedRobot(service_, "a reader").conflicts(Wait(TimePoint::max())).value();
    const auto interfere = [&](const std::string& kept, const std::string& used) {
      return conflicts.conflict(kept, used) || conflicts.influence(kept, used);
    };
    std::list<std::string> runs;  // the latest first
    for (const RobotMission::Action& action : mission_.actions) {
      std::list<std::string> now{action.controller};
      for (const std::string& kept : runs) {
        if (kept != action.controller &&
            std::ranges::none_of(now, [&](const auto& one) { return interfere(kept, one); }))
          now.push_back(kept);
      }
      if (action.stop) now.pop_front();
      runs = std::move(now);
    }
    return {runs.begin(), runs.end()};
  }

  /// The robot is free, and goes wherever it is sent.
  std::optional<std::string> after_all() {
    robot_.asking.ask({});
    if (robot_.runtime.served().lease_holder()) return "the mission has ended but still commands the robot";
    if (!taker_wants_.empty() && trouble_.fault_in == 0 &&
        !equivalent(robot_.runtime.belief(), united(controllers_, {taker_wants_}))) {
      return "the robot does not run what it was taken over for";
    }
    for (const model::Network& controller : controllers_) {
      const auto result = robot_.runtime.switch_to(controller.name);
      if (result.outcome != runtime::Outcome::Done) return "the robot cannot switch any more";
      if (!equivalent(robot_.host.observe(), controller)) return "a switch left something else";
    }
    return std::nullopt;
  }

  Random random_;
  const Trouble trouble_;
  const std::vector<model::Network> controllers_;
  const RobotMission mission_;
  const bool is_concurrent_;
  runtime::testing::StandInRobot robot_;
  runtime::RuntimeService service_;
  std::shared_ptr<remote_robot::ServedRobot> served_;
  std::shared_ptr<CheckedRobot> checked_;
  std::string taker_wants_;
  std::map<std::string, bool> began_late_;
  int succeeded_ = 0;
};

void check(std::uint64_t seed, const Trouble& trouble) {
  RobotRun run(seed, trouble);
  const auto wrong = run.run();
  if (wrong) RC_FAIL(*wrong + "\n" + run.text());
}

RC_GTEST_PROP(MissionsOnRobots, RunJustTheUnionsThatTheirActionsNeed, (std::uint64_t seed)) {
  check(seed, {.other_asks = true});
}

RC_GTEST_PROP(MissionsOnRobots, SurviveFailingActions, (std::uint64_t seed)) {
  check(seed, {.fault_in = 20});
}

RC_GTEST_PROP(MissionsOnRobots, NeverSucceedWithARobotThatWasTakenOver, (std::uint64_t seed)) {
  check(seed, {.take_over = true, .other_asks = true});
}

RC_GTEST_PROP(MissionsOnRobots, AreTakenOverWhileActionsFail, (std::uint64_t seed)) {
  check(seed, {.fault_in = 20, .take_over = true});
}

struct Planted {
  Defect defect;
  Trouble trouble;
  const char* found_by;  ///< a part of what is said of it
};
class PlantedDefects : public ::testing::TestWithParam<Planted> {};

TEST_P(PlantedDefects, AreFound) {
  const Planted& planted = GetParam();
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto wrong = RobotRun(seed, planted.trouble, planted.defect).run();
    if (!wrong) continue;
    EXPECT_THAT(*wrong, ::testing::HasSubstr(planted.found_by));
    return;
  }
  FAIL() << "not found in 200 missions";
}

INSTANTIATE_TEST_SUITE_P(
    OfRobots, PlantedDefects,
    ::testing::Values(
        Planted{Defect::LosesAController, {}, "was requested, but the robot runs"},
        Planted{Defect::HidesFailures, {.fault_in = 5}, "was requested, but the robot runs"},
        Planted{Defect::HidesTheTakeOver, {.take_over = true}, "although the robot had been taken over"},
        Planted{Defect::TakesTheRobotBack, {.take_over = true}, "taken over"}));

/// Leases against a model of who holds the robot.
RC_GTEST_PROP(Leases, BelongToOneHolderAtATime, (std::uint64_t seed)) {
  Random random(seed);
  runtime::testing::StandInRobot robot;
  const auto controllers = random_controllers(random);
  for (const auto& one : controllers)
    ASSERT_FALSE(robot.runtime.add_controller(one).has_errors());
  std::vector<std::uint64_t> numbers{0};
  std::uint64_t held = 0;
  for (int i = 0; i < 30; ++i) {
    const std::uint64_t any = any_of(random, numbers);
    if (one_in(random, 3)) {
      const auto taken = robot.runtime.served().take_lease("holder " + std::to_string(i));
      RC_ASSERT(taken.has_value() == (held == 0));
      if (taken) numbers.push_back(held = *taken);
    } else if (one_in(random, 3)) {
      robot.runtime.served().end_lease(any);
      if (any == held) held = 0;
    } else {
      runtime::RequestOptions options{.who = "user", .lease = any, .take_over = one_in(random, 3)};
      const auto result = robot.runtime.switch_to(any_of(random, controllers).name, options);
      const bool may = any == held || (any == 0 && options.take_over);
      RC_ASSERT((result.outcome == runtime::Outcome::Done) == may);
      if (may && any != held) held = 0;
    }
    RC_ASSERT(robot.runtime.served().lease_holder().has_value() == (held != 0));
    for (const std::uint64_t number : numbers)
      RC_ASSERT(number == 0 ||
                robot.runtime.served().lease_standing(number).lost_to.has_value() == (number != held));
  }
}

}  // namespace
}  // namespace segue::testing
