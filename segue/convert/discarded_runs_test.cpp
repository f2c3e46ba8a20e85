// SPDX-License-Identifier: Apache-2.0
//
// Runs of pure and sensing actions that are discarded leave no trace: neither in global variables nor in the
// persistent variables of scripts.
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>
#include <segue/convert/test_support.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_script/script_runner.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace segue::convert {
namespace {

using ::testing::HasSubstr;
using type::Value;

/// Completers that wait for an event, in any thread.
class Gate {
 public:
  void wait(std::function<void()> then) {
    {
      const Lock lock(mutex_);
      if (!open_) return waiting_.push_back(std::move(then));
    }
    then();
  }
  void open() {
    std::vector<std::function<void()>> waiting;
    {
      const Lock lock(mutex_);
      open_ = true;
      waiting.swap(waiting_);
    }
    for (const auto& then : waiting)
      then();
  }

 private:
  Mutex mutex_;
  bool open_ = false;
  std::vector<std::function<void()>> waiting_;
};

/// Runs a function now and ends when the gate opens, or when it is preempted.
class Waiting final : public mission::ActionRunner {
 public:
  Waiting(Gate& gate, mission::Function function) : gate_(gate), function_(std::move(function)) {}
  std::optional<mission::Ending> start(mission::ActionCall& call) override {
    const mission::Ending ending = function_(call);
    const auto completer = call.defer([] {});
    gate_.wait([completer, ending] { completer(ending, {}); });
    return std::nullopt;
  }

 private:
  Gate& gate_;
  mission::Function function_;
};

/// It ends with success unless it says otherwise.
std::string script(const std::string& body) {
  std::string text = "{python: {text: \"def execute(self, inputs, outputs, gvm):\\n";
  for (const char c : "  " + body + "\nreturn 'success'") {
    if (c == '"') text += '\\';
    text += c == '\n' ? "\\n  " : std::string(1, c);
  }
  return text + "\"}}";
}

using ConcurrentRun = Run;  // in a fixture, Run is a function of GoogleTest

class DiscardedRuns : public ::testing::TestWithParam<bool> {
 protected:
  DiscardedRuns() {
    runners_.set_scripts(std::make_shared<mission::ScriptRunner>());
    set_log_sink([this](LogLevel, std::string_view, std::string_view text) {
      if (text == "ready") ready_.open();
    });
  }
  ~DiscardedRuns() override { set_log_sink({}); }

  const mission::MissionResult& run(const std::string& text) {
    Diagnostics diagnostics;
    auto mission = mission::read_mission(text, "m.yaml", diagnostics);
    EXPECT_TRUE(mission) << to_string(diagnostics) << text;
    RunOptions options;
    options.strict = GetParam();
    run_ =
        ConcurrentRun::create(mission::Program::compile(std::move(*mission)).value(), runners_, {}, options)
            .value();
    return result_ = run_->run();
  }
  [[nodiscard]] const Value& output() const { return result_.outputs.at(0); }

  /// The decision goes as given, but not before the script on one of its ways has begun.
  void decide(std::vector<mission::Outcome> turns) {
    runners_.add("decide",
                 std::make_shared<Waiting>(ready_, [turns, i = std::size_t{0}](mission::ActionCall&) mutable {
                   return mission::Ending{turns.at(i++), {}};
                 }));
  }

  Gate ready_;
  mission::Runners runners_;
  std::unique_ptr<ConcurrentRun> run_;
  mission::MissionResult result_;
};
INSTANTIATE_TEST_SUITE_P(Both, DiscardedRuns, ::testing::Bool(),
                         [](const auto& strict) { return strict.param ? "Strict" : "NotStrict"; });

/// `look` runs ahead of a decision that the first time goes elsewhere.
std::string decision(const std::string& look) {
  return R"(
mission: m
actions:
  decide: {outcomes: [yes, no], effects: ["+decided"], expect: {outcome: yes}, run: {callback: decide}}
  look:
    pure: true
    outputs: {seen: any}
    run: )" +
         look + R"(
outputs: {seen: any}
start: decide
flows: [look.seen -> outputs.seen]
states:
  decide: {on: {yes: look, no: decide}}
  look: {on: {success: return success}}
)";
}

TEST_P(DiscardedRuns, AScriptOnAWayThatIsNotTakenSetsNoVariable) {
  decide({1, 0});
  run(
      decision(script("count = gvm.get_variable('n', default=0) + 1\n"
                      "gvm.set_variable('n', count)\n"
                      "key = gvm.lock_variable('locked')\n"
                      "gvm.set_variable('never', 1, access_key=None) if not key else None\n"
                      "outputs['seen'] = [count, key is not False]\n"
                      "print('ready')")));
  EXPECT_EQ(output(), Value(Value::List{1, true}));
  EXPECT_EQ(run_->globals().get("n"), Value(1));
}

TEST_P(DiscardedRuns, AScriptOnAWayThatIsNotTakenRemembersNothing) {
  decide({1, 0});
  run(
      decision(script("self.persistent_variables['n'] = self.persistent_variables.get('n', 0) + 1\n"
                      "outputs['seen'] = self.persistent_variables['n']\n"
                      "print('ready')")));
  EXPECT_EQ(output(), Value(1));
}

TEST_P(DiscardedRuns, ACppActionOnAWayThatIsNotTakenSetsNoVariable) {
  decide({1, 0});
  runners_.add("look", [this](mission::ActionCall& call) {
    EXPECT_TRUE(call.may_be_discarded());
    const auto before = call.globals().get("n");
    const Value count(before ? before->as_int() + 1 : 1);
    EXPECT_TRUE(call.globals().set("n", count));
    call.set_output("seen", count);
    ready_.open();
    return mission::Ending{};
  });
  run(decision("{callback: look}"));
  EXPECT_EQ(output(), Value(1));
  EXPECT_EQ(run_->globals().get("n"), Value(1));
}

TEST_P(DiscardedRuns, PersistentVariablesThatCannotBeCopiedAreAnError) {
  decide({0});
  const auto& result =
      run(decision(script("import threading\n"
                          "print('ready')\n"
                          "self.persistent_variables['lock'] = threading.Lock()\n"
                          "outputs['seen'] = 1")));
  EXPECT_EQ(result.outcome, 0) << result.error;  // nothing was to be copied yet
  decide({0});
  const std::string twice = R"(
mission: m
actions:
  look: {pure: true, outcomes: [more, enough], run: )" +
                            script(
                                "'lock' in self.persistent_variables\n"
                                "import threading\n"
                                "self.persistent_variables['lock'] = threading.Lock()\n"
                                "return 'more'") +
                            R"(}
start: look
states:
  look: {on: {more: look, enough: return success}}
)";
  EXPECT_THAT(run(twice).error, HasSubstr("must be copied"));
}

/// A chain of pure scripts, each of which is independent of the others but for variables.
TEST_P(DiscardedRuns, ScriptsSeeWhatScriptsBeforeThemHaveSet) {
  std::string text = "mission: m\nactions:\n";
  std::string states = "start: s1\nstates:\n";
  for (int i = 1; i <= 4; ++i) {
    const std::string n = std::to_string(i);
    text += "  s" + n + ": {pure: true, outputs: {seen: any}, run: " +
            script("seen = gvm.get_variable('seen', default=[]) + [" + n +
                   "]\ngvm.set_variable('seen', seen)\noutputs['seen'] = seen") +
            "}\n";
    states +=
        "  s" + n + ": {on: {success: " + (i == 4 ? "return success" : "s" + std::to_string(i + 1)) + "}}\n";
  }
  run(text + "outputs: {seen: any}\nflows: [s4.seen -> outputs.seen]\n" + states);
  EXPECT_EQ(output(), Value(Value::List{1, 2, 3, 4}));
}

TEST_P(DiscardedRuns, PersistentVariablesCountEveryRunThatCounts) {
  run(R"(
mission: m
actions:
  look: {pure: true, outputs: {n: int}, outcomes: [more, enough], expect: {outcome: more}, run: )" +
      script("n = self.persistent_variables.get('n', 0) + 1\n"
             "self.persistent_variables = {'n': n}\n"
             "outputs['n'] = n\n"
             "return 'enough' if n == 5 else 'more'") +
      R"(}
outputs: {n: int}
start: look
flows: [look.n -> outputs.n]
states:
  look: {on: {more: look, enough: return success}}
)");
  EXPECT_EQ(output(), Value(5));
}

TEST_P(DiscardedRuns, AnActionThatMayTouchAnythingSeesWhatPureActionsHaveSet) {
  run(R"(
mission: m
actions:
  look: {pure: true, run: )" +
      script("gvm.set_variable('n', 3)") + R"(}
  use: {outputs: {n: any}, run: )" +
      script("outputs['n'] = gvm.get_variable('n')") + R"(}
outputs: {n: any}
start: look
flows: [use.n -> outputs.n]
states:
  look: {on: {success: use}}
  use: {on: {success: return success}}
)");
  EXPECT_EQ(output(), Value(3));
}

/// `use` declares only a fact, so it does not wait for `look`.
TEST_P(DiscardedRuns, AVariableThatWasUsedTooEarlyIsAnErrorAndNoOtherResult) {
  Gate used;
  runners_.add("look", std::make_shared<Waiting>(used, [](mission::ActionCall& call) {
                 EXPECT_TRUE(call.globals().set("n", 3));
                 return mission::Ending{};
               }));
  runners_.add("use", [&](mission::ActionCall& call) {
    const auto n = call.globals().get("n");
    call.set_output("n", n ? *n : Value());
    used.open();
    return mission::Ending{};
  });
  if (GetParam()) used.open();  // a strict run does not come that far before `look` has ended
  const auto& result = run(R"(
mission: m
actions:
  look: {pure: true, run: {callback: look}}
  use: {effects: ["+used"], outputs: {n: any}, run: {callback: use}}
outputs: {n: any}
start: look
flows: [use.n -> outputs.n]
states:
  look: {on: {success: use}}
  use: {on: {success: return success}}
)");
  if (GetParam()) {
    EXPECT_EQ(result.outcome, 0) << result.error;
    EXPECT_EQ(output(), Value(3));
    return;
  }
  EXPECT_EQ(result.outcome, mission::kAborted);
  EXPECT_THAT(result.error, HasSubstr("'n', which 'use' had already used"));
}

/// Neither branch comes before the other, so both see what the other sets.
TEST_P(DiscardedRuns, BranchesOfABarrierMayWaitForVariablesOfEachOther) {
  if (GetParam()) return;  // in a strict run, `then` waits until `first` can no longer fail
  const std::string wait = script(
      "while gvm.get_variable('n') is None and not self.preemptive_wait(0.001):\n  pass\n"
      "return 'success'");
  const auto& result = run(R"(
mission: m
actions:
  first: {sensing: true, effects: ["+a"], run: )" +
                           wait + R"(}
  then: {effects: ["+c"], preconditions: ["b"], run: )" +
                           script("gvm.set_variable('n', 1)") + R"(}
  look: {pure: true, effects: ["+b"], run: )" +
                           script("gvm.set_variable('m', gvm.get_variable('m', default=0) + 1)") + R"(}
  last: {sensing: true, effects: ["+d"], run: )" +
                           wait + R"(}
  decide: {run: {decide: [{outcome: success}]}}
kind: barrier
states:
  first: {}
  middle:
    start: look
    states:
      look: {on: {success: then}}
      then: {on: {success: return success}}
  last: {}
  decider: {kind: decider, action: decide, on: {success: return success}}
)");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(run_->globals().get("m"), Value(1));
}

/// Uses variables and ends seconds later.
class Using final : public mission::ActionRunner {
 public:
  Using(int seconds, std::function<void(mission::Globals&)> use) : seconds_(seconds), use_(std::move(use)) {}
  std::optional<mission::Ending> start(mission::ActionCall& call) override {
    ++begun;
    use_(call.globals());
    call.end_after(std::chrono::seconds(seconds_), {});
    return std::nullopt;
  }
  int begun = 0;

 private:
  const int seconds_;
  const std::function<void(mission::Globals&)> use_;
};

/// Writes of a branch may come before or after the reads of the other one, so they are no reason to run
/// again: the action would lose the arm to the container. A write before the barrier is a reason.
TEST(VariablesOfABarrier, AnActionIsNotRepeatedForWhatAParallelOneSets) {
  const std::string text = R"(
mission: m
actions:
  before: {pure: true, run: {callback: before}}
  writer: {pure: true, run: {callback: writer}}
  reader: {pure: true, resources: [{block: arm}], run: {callback: reader}}
  after: {pure: true, run: {callback: after}}
  both: {run: {decide: [{outcome: success}]}}
start: before
states:
  before: {on: {success: beside}}
  beside:
    kind: barrier
    on: {success: container}
    states:
      writer: {}
      reader: {}
      both: {kind: decider, on: {success: return success}}
  container:
    resources: [{block: arm}]
    start: after
    on: {success: return success}
    states:
      after: {on: {success: return success}}
)";
  const auto sets = [](const std::string& name) {
    return [name](mission::Globals& globals) { EXPECT_TRUE(globals.set(name, Value(1))); };
  };
  std::vector<std::string> seen;
  const auto sees = [&](mission::Globals& globals) {
    seen.clear();
    const Value all = globals.snapshot();
    for (const auto& [name, value] : all.as_map())
      seen.push_back(name);
  };
  const auto reader = std::make_shared<Using>(3, sees);
  const auto after = std::make_shared<Using>(1, sees);
  mission::Runners runners;
  runners.add("before", std::make_shared<Using>(1, sets("before")));
  runners.add("writer", std::make_shared<Using>(2, sets("beside")));
  runners.add("reader", reader);
  runners.add("after", after);
  const testing::VirtualRun run(text, {}, runners);
  EXPECT_EQ(run.result.outcome_name, "success") << run.result.error;
  EXPECT_EQ(reader->begun, 1) << "it takes its units in program order, so it begins when `before` has ended";
  EXPECT_THAT(seen, ::testing::ElementsAre("before", "beside"));
  EXPECT_EQ(run.network_result().makespan, std::chrono::seconds(5));
}

}  // namespace
}  // namespace segue::convert
