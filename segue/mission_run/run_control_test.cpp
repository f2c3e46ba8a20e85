// SPDX-License-Identifier: Apache-2.0
//
// Runs that are steered from other threads: paused, stepped, held at breakpoints, sent elsewhere.
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission_run/loaded_mission_test_support.hpp>
#include <segue/mission_run/run_control.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

namespace segue::mission_run {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Paths = std::vector<std::string>;

/// Ends what it is told to, and tells when it begins.
class Waiting final : public mission::ActionRunner {
 public:
  std::optional<mission::Ending> start(mission::ActionCall& call) override {
    const Lock lock(mutex_);
    end_ = call.defer([] {});
    ++begun_;
    changed_.notify_all();
    return std::nullopt;
  }
  void end() {
    const Lock lock(mutex_);
    end_({}, {});
  }
  bool wait_until_begun(int count) {
    Lock lock(mutex_);
    return changed_.wait_for(mutex_, std::chrono::seconds(60), [&] { return begun_ >= count; });
  }
  int begun() {
    const Lock lock(mutex_);
    return begun_;
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  mission::Completer end_;
  int begun_ = 0;
};

TEST_F(LoadedMissions, BeginNothingWhileTheyArePaused) {
  const LoadedMission plan = load("m.yaml",
                                  "mission: m\nactions: {a: {run: {callback: wait}}}\nstart: first\n"
                                  "states: {first: {action: a, on: {success: second}}, second: {action: a, "
                                  "on: {success: return success}}}\n");
  for (const RunMode& mode : kBothModes) {
    for (const bool stops : {false, true}) {
      const auto waiting = std::make_shared<Waiting>();
      RunControl control;
      std::stop_source stop;
      RunRequest request;
      if (is_concurrent(mode)) {
        request.mode = Concurrent{.control = &control};
      } else {
        request.mode = Sequential{.stepping = Stepping{.control = control}};
      }
      request.runners.add("wait", waiting);
      std::string outcome;
      std::jthread thread([&] { outcome = plan.run(request, stop.get_token()).value()->overview().outcome; });
      ASSERT_TRUE(waiting->wait_until_begun(1));
      control.pause();
      waiting->end();
      EXPECT_EQ(waiting->begun(), 1);
      if (stops) {
        stop.request_stop();
      } else {
        control.resume();
        ASSERT_TRUE(waiting->wait_until_begun(2));
        waiting->end();
      }
      thread.join();
      EXPECT_EQ(outcome, stops ? "preempted" : "success");
    }
  }
}

constexpr const char* kNested = R"(mission: nested
actions:
  look: {outputs: {found: int}, run: {simulated: {duration: 1s, outputs: {found: 7}}}}
  take: {inputs: {what: int}, run: {simulated: {duration: 1s}}}
start: fetch
states:
  fetch:
    start: look
    flows: [look.found -> take.what]
    states:
      look: {on: {success: take}}
      take: {on: {success: return success}}
    on: {success: again}
  again: {action: look, on: {success: return success}}
)";

constexpr const char* kOneWait = R"(mission: m
actions: {a: {run: {callback: wait}}}
start: first
states: {first: {action: a, on: {success: return success}}}
)";

/// A mission that runs on a thread of its own until it is destroyed.
class Steered {
 public:
  Steered(const LoadedMission& plan, RunRequest request, Paths breakpoints = {})
      : plan_(plan), request_(std::move(request)) {
    if (auto* concurrent = std::get_if<Concurrent>(&request_.mode)) concurrent->control = &control_;
    if (auto* sequential = std::get_if<Sequential>(&request_.mode)) {
      sequential->stepping = Stepping{.control = control_,
                                      .breakpoints = std::move(breakpoints),
                                      .steps_back = true,
                                      .on_held = [this](const Paths& paths) { held_before(paths); }};
    }
    thread_ = std::jthread([this] { ended_.set_value(plan_.run(request_, stop_.get_token())); });
  }
  ~Steered() { stop_.request_stop(); }
  Steered(const Steered&) = delete;
  Steered& operator=(const Steered&) = delete;

  RunControl& control() { return control_; }
  void stop() { stop_.request_stop(); }
  /// Waits until it is held and at rest.
  Paths held_at() {
    std::optional<Paths> at;
    Lock lock(mutex_);
    const bool held = held_.wait_for(mutex_, std::chrono::seconds(60), [&] {
      at = control_.position().at;
      return at.has_value();
    });
    return held ? *at : Paths{"it is not held"};
  }
  Paths step(RunControl::Step step) {
    auto done = std::make_shared<std::promise<Result<void>>>();
    control_.step(step, [done](Result<void> outcome) { done->set_value(std::move(outcome)); });
    const auto outcome = done->get_future().get();
    return outcome ? held_at() : Paths{to_string(outcome.error())};
  }
  Result<void> set_breakpoints(Paths paths) {
    auto done = std::make_shared<std::promise<Result<void>>>();
    control_.set_breakpoints(std::move(paths), [done](Result<void> outcome) { done->set_value(outcome); });
    return done->get_future().get();
  }
  Result<void> go_on_at(const std::string& path) {
    auto done = std::make_shared<std::promise<Result<void>>>();
    control_.go_on_at(path, [done](Result<void> outcome) { done->set_value(outcome); });
    return done->get_future().get();
  }
  Result<type::Value> values_of(const std::string& path) {
    auto done = std::make_shared<std::promise<Result<type::Value>>>();
    control_.values_of(path, [done](Result<type::Value> answer) { done->set_value(std::move(answer)); });
    return done->get_future().get();
  }
  /// Before which states it was held, once it has ended.
  [[nodiscard]] const Paths& told() const { return told_; }
  std::string outcome() {
    const auto run = ended_.get_future().get();
    return run ? (*run)->overview().outcome : to_string(run.error());
  }

 private:
  void held_before(const Paths& paths) {
    const Lock lock(mutex_);
    told_.insert(told_.end(), paths.begin(), paths.end());
    held_.notify_all();
  }

  const LoadedMission& plan_;
  RunRequest request_;
  RunControl control_;
  std::stop_source stop_;
  Mutex mutex_;             ///< protects told_ while the thread runs
  ConditionVariable held_;  ///< told_ has become more
  Paths told_;              ///< by the thread
  std::promise<Result<std::unique_ptr<FinishedRun>>> ended_;
  std::jthread thread_;
};

using Steering = LoadedMissions;

TEST_F(Steering, StepsFromABreakpointToTheEnd) {
  const LoadedMission plan = load("m.yaml", kNested);
  Steered run(plan, request(Sequential{}), {"fetch"});
  EXPECT_THAT(run.held_at(), ElementsAre("fetch"));
  EXPECT_TRUE(run.control().paused());
  const auto position = run.control().position();
  EXPECT_TRUE(position.steps && position.back);
  EXPECT_THAT(position.breakpoints, ElementsAre("fetch"));
  EXPECT_THAT(run.step(RunControl::Step::Into), ElementsAre("fetch/look"));
  EXPECT_TRUE(run.values_of("fetch/look"));
  EXPECT_THAT(run.step(RunControl::Step::Over), ElementsAre("fetch/take"));
  EXPECT_THAT(run.step(RunControl::Step::Back), ElementsAre("fetch/look"));
  EXPECT_THAT(run.step(RunControl::Step::Over), ElementsAre("fetch/take"));
  EXPECT_THAT(run.step(RunControl::Step::Out), ElementsAre("again"));
  run.control().resume();
  EXPECT_EQ(run.outcome(), "success");
  EXPECT_FALSE(run.control().paused());
  EXPECT_THAT(run.told(),
              ElementsAre("fetch", "fetch/look", "fetch/take", "fetch/look", "fetch/take", "again"))
      << "each time once";
}

TEST_F(Steering, ChangesBreakpointsAndGoesOnElsewhere) {
  const LoadedMission plan = load("m.yaml", kNested);
  Steered run(plan, request(Sequential{}), {"fetch"});
  EXPECT_THAT(run.held_at(), ElementsAre("fetch"));
  EXPECT_THAT(to_string(run.set_breakpoints({"nowhere"}).error()), HasSubstr("there is no state 'nowhere'"));
  EXPECT_THAT(run.control().position().breakpoints, ElementsAre("fetch"));
  EXPECT_TRUE(run.set_breakpoints({"fetch/take"}));
  run.control().resume();
  EXPECT_THAT(run.held_at(), ElementsAre("fetch/take"));
  const auto values = run.values_of("fetch/take");
  ASSERT_TRUE(values) << to_string(values.error());
  EXPECT_EQ(*values->find("when"), type::Value("next"));
  EXPECT_EQ(*values->find("inputs")->as_list().at(0).find("text"), type::Value("7"));
  EXPECT_FALSE(run.go_on_at("nowhere"));
  EXPECT_TRUE(run.go_on_at("again"));
  EXPECT_THAT(run.held_at(), ElementsAre("again"));
  EXPECT_TRUE(run.set_breakpoints({}));
  run.control().resume();
  EXPECT_EQ(run.outcome(), "success");
}

constexpr const char* kWatchedWork = R"(mission: watched
actions:
  work: {run: {callback: work}}
  watch: {run: {callback: wait}}
kind: preemptive
states:
  work:
    start: one
    states:
      one: {action: work, on: {success: two}}
      two: {action: work, on: {success: three}}
      three: {action: work, on: {success: return success}}
    on: {success: return success}
  watch: {on: {success: return success}}
)";

TEST_F(Steering, ABreakpointHoldsTheWorkBesideAWatchThatGoesOn) {
  const auto watch = std::make_shared<Waiting>();
  const LoadedMission plan = load("m.yaml", kWatchedWork);
  RunRequest wanted = request(Sequential{});
  wanted.runners.add("wait", watch);
  wanted.runners.add("work", [](mission::ActionCall&) { return mission::Ending{}; });
  Steered run(plan, wanted, {"work/two"});
  EXPECT_THAT(run.held_at(), ElementsAre("work/two"));
  ASSERT_TRUE(watch->wait_until_begun(1));
  EXPECT_THAT(run.step(RunControl::Step::Back), ElementsAre(HasSubstr("still is")));
  EXPECT_THAT(run.step(RunControl::Step::Over), ElementsAre("work/three"));
  watch->end();
  EXPECT_EQ(run.outcome(), "success");
  EXPECT_THAT(run.told(), ElementsAre("work/two", "work/three"));
}

TEST_F(Steering, WhatIsHeldCanBeStopped) {
  const LoadedMission plan = load("m.yaml", kNested);
  Steered run(plan, request(Sequential{}), {"fetch/take"});
  EXPECT_THAT(run.held_at(), ElementsAre("fetch/take"));
  run.stop();
  EXPECT_EQ(run.outcome(), "preempted");
}

TEST_F(Steering, RefusesStepsWhileItRuns) {
  const auto waiting = std::make_shared<Waiting>();
  const LoadedMission plan = load("m.yaml", kOneWait);
  RunRequest request;
  request.runners.add("wait", waiting);
  Steered run(plan, request);
  ASSERT_TRUE(waiting->wait_until_begun(1));
  EXPECT_THAT(run.step(RunControl::Step::Over), ElementsAre(HasSubstr("the mission is not held")));
  EXPECT_THAT(run.step(RunControl::Step::Back), ElementsAre(HasSubstr("the mission is not held")));
  waiting->end();
  EXPECT_EQ(run.outcome(), "success");
  EXPECT_THAT(run.step(RunControl::Step::Over), ElementsAre(HasSubstr("the mission does not run")));
}

TEST_F(Steering, AConcurrentRunHasNoSteps) {
  const auto waiting = std::make_shared<Waiting>();
  const LoadedMission plan = load("m.yaml", kOneWait);
  RunRequest request;
  request.mode = Concurrent{};
  request.runners.add("wait", waiting);
  Steered run(plan, request);
  ASSERT_TRUE(waiting->wait_until_begun(1));
  EXPECT_FALSE(run.control().position().steps);
  EXPECT_THAT(run.step(RunControl::Step::Over), ElementsAre(HasSubstr("--mode sequential")));
  waiting->end();
  EXPECT_EQ(run.outcome(), "success");
}

TEST_F(Steering, IsRefusedBeforeAnythingIsExecuted) {
  const LoadedMission plan = load("m.yaml", kNested);
  RunControl control;
  RunRequest wrong =
      request(Sequential{.stepping = Stepping{.control = control, .breakpoints = {"fetch/nowhere"}}});
  EXPECT_EQ(plan.run(wrong).error().code, ErrorCode::NotFound);
  wrong = request(Sequential{.stepping = Stepping{.control = control, .steps_back = true}});
  wrong.journal = Journal{folder_ / "run.journal"};
  EXPECT_EQ(plan.run(wrong).error().code, ErrorCode::Unsupported);
}

/// The answer comes whether the run reaches the question or ends before.
TEST_F(Steering, AnswersEveryQuestionOnce) {
  const LoadedMission plan = load("m.yaml", kNested);
  for (int i = 0; i < 50; ++i) {
    Steered run(plan, request(Sequential{}), {"again"});
    EXPECT_THAT(run.held_at(), ElementsAre("again"));
    run.control().resume();
    int answers = 0;
    Mutex mutex;
    {
      std::vector<std::jthread> askers;
      for (int asker = 0; asker < 3; ++asker) {
        askers.emplace_back([&] {
          (void)run.values_of("fetch");
          const Lock lock(mutex);
          ++answers;
        });
      }
    }
    EXPECT_EQ(answers, 3);
    EXPECT_EQ(run.outcome(), "success");
  }
}

TEST_F(Steering, TheLastWishCounts) {
  const LoadedMission plan = load("m.yaml", kNested);
  for (int i = 0; i < 50; ++i) {
    Steered run(plan, request(Sequential{}), {"fetch", "again"});
    EXPECT_THAT(run.held_at(), ElementsAre("fetch"));
    run.control().resume();
    run.control().pause();
    EXPECT_THAT(run.held_at(), Not(ElementsAre("it is not held")));
    EXPECT_TRUE(run.set_breakpoints({}));
    run.control().pause();
    run.control().resume();
    EXPECT_EQ(run.outcome(), "success");
  }
}

}  // namespace
}  // namespace segue::mission_run
