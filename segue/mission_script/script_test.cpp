// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_engine/engine.hpp>
#include <segue/mission_script/script_runner.hpp>
#include <segue/mission_script/scripted_data.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

namespace segue::mission {
namespace {

using namespace std::chrono_literals;
using segue::testing::eventually;
using segue::testing::kPatience;
using std::filesystem::path;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using type::Value;

/// Python that never gives up the interpreter's lock.
const std::string kHold = "re.match('(a+)+$', 'a' * 100 + 'b')";

/// Collects the lines that scripts print and log, as they come.
class Lines {
 public:
  Lines() {
    set_log_level(LogLevel::Debug);
    set_log_sink([this](LogLevel level, std::string_view source, std::string_view text) {
      const Lock guard(mutex_);
      text_ += std::string(to_string(level)) + " " + std::string(source) + ": " + std::string(text) + "\n";
      changed_.notify_all();
    });
  }
  ~Lines() {
    set_log_sink({});
    set_log_level(LogLevel::Info);
  }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  std::string text() {
    const Lock guard(mutex_);
    return text_;
  }
  bool wait_for(const std::string& part) {
    Lock guard(mutex_);
    return changed_.wait_for(mutex_, kPatience, [&] { return text_.find(part) != std::string::npos; });
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  std::string text_;
};

bool is_gone(pid_t pid) {
  return ::kill(pid, 0) != 0;
}

/// A script as the text of a YAML block.
std::string indented(const std::string& script, const std::string& with) {
  std::string text = with;
  for (const char c : script) {
    text += c;
    if (c == '\n') text += with;
  }
  return text;
}

/// An action of a mission file, `head` being what stands beside `run`.
std::string action(const std::string& name, const std::string& script, const std::string& head = "") {
  return "  " + name + ":\n" + (head.empty() ? "" : indented(head, "    ") + "\n") +
         "    run:\n      python:\n        text: |\n" + indented(script, "          ") + "\n";
}

std::string execute(const std::string& body) {
  return "def execute(self, inputs, outputs, gvm):\n" + indented(body, "  ");
}

class Scripts : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "segue-script-XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override {
    engine_.reset();
    runner_.reset();
    std::filesystem::remove_all(folder_);
  }

  void load(const std::string& text) {
    if (!runner_) runner_ = std::make_shared<ScriptRunner>(options_);
    Diagnostics diagnostics;
    auto mission = read_mission(text, (folder_ / "m.yaml").string(), diagnostics);
    ASSERT_TRUE(mission) << to_string(diagnostics) << text;
    auto program = Program::compile(std::move(*mission));
    ASSERT_TRUE(program) << to_string(program.error());
    Runners runners;
    runners.set_scripts(runner_);
    auto engine = Engine::create(*program, runners, engine_options_);
    ASSERT_TRUE(engine) << to_string(engine.error());
    engine_ = std::move(*engine);
  }
  const MissionResult& run(const std::string& text) {
    load(text);
    if (::testing::Test::HasFatalFailure()) std::abort();
    engine_->run();
    return engine_->result();
  }
  /// A mission of one action.
  const MissionResult& run_one(const std::string& script, const std::string& head = "") {
    return run("mission: m\nactions:\n" + action("a", script, head) + "action: a\n");
  }
  const MissionResult& run_body(const std::string& body, const std::string& head = "") {
    return run_one(execute(body), head);
  }
  /// The only output, `x` of any type, of a script.
  Value output_of(const std::string& body, const std::string& more = "") {
    const auto& result = run_body(body, "outputs: {x: any}" + (more.empty() ? "" : "\n" + more));
    EXPECT_EQ(result.outcome, 0) << result.error;
    return result.outputs.empty() ? Value() : result.outputs.front();
  }
  std::string error_of(const std::string& body, const std::string& head = "") {
    const auto& result = run_body(body, head);
    EXPECT_EQ(result.outcome, kAborted);
    return result.error;
  }
  /// Why a mission with a script cannot start.
  [[nodiscard]] std::string refusal() const {
    Diagnostics diagnostics;
    auto mission = read_mission("mission: m\nactions:\n" + action("a", execute("return 0")) + "action: a\n",
                                (folder_ / "m.yaml").string(), diagnostics);
    Runners runners;
    runners.set_scripts(std::make_shared<ScriptRunner>(options_));
    const auto engine = Engine::create(Program::compile(std::move(*mission)).value(), runners, {});
    return engine ? "" : engine.error().message;
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  path folder_;
  ScriptOptions options_;
  EngineOptions engine_options_;
  Lines lines_;
  std::shared_ptr<ScriptRunner> runner_;
  std::unique_ptr<Engine> engine_;
};

// Endings

TEST_F(Scripts, endWithTheNumberOrTheNameOfAnOutcome) {
  EXPECT_EQ(run_body("return 1", "outcomes: [a, b]").outcome_name, "b");
  EXPECT_EQ(run_body("return 'b'", "outcomes: [a, b]").outcome_name, "b");
  EXPECT_EQ(run_body("return -2").outcome, kPreempted);
  EXPECT_THAT(error_of("return 'aborted'"), HasSubstr("returned 'aborted'"));
}

TEST_F(Scripts, abortWhereTheyReturnNoOutcome) {
  EXPECT_EQ(error_of("pass"),
            "m: execute() returned None, which is none of its outcomes: 'success', 'aborted', "
            "'preempted'");
  EXPECT_THAT(error_of("return 7"), HasSubstr("returned 7,"));
  EXPECT_THAT(error_of("return 'sucess'"), HasSubstr("returned 'sucess',"));
  EXPECT_THAT(error_of("return [0]"), HasSubstr("returned [0],"));
}

TEST_F(Scripts, thatRaiseAbortWithTheErrorAndItsPlace) {
  const auto& result = run_one("def helper():\n  raise ValueError('no box')\n" + execute("helper()"));
  EXPECT_EQ(result.outcome, kAborted);
  EXPECT_EQ(result.error, "m:2: ValueError: no box");
  EXPECT_THAT(lines_.text(), HasSubstr("raise ValueError('no box')"));
  EXPECT_EQ(error_of("import sys; sys.exit(3)"), "m:2: SystemExit: 3");
  EXPECT_EQ(error_of("import json; json.loads('{')").substr(0, 22), "m:2: json.decoder.JSON");
}

TEST_F(Scripts, thatCannotBeCompiledSayWhere) {
  EXPECT_THAT(run_one("def execute(self, inputs, outputs, gvm):\n  return 0\n  x = = 1\n").error,
              StartsWith("m:3: SyntaxError: "));
  EXPECT_THAT(run_one("x = 1 / 0\n").error, StartsWith("m:1: ZeroDivisionError"));
}

TEST_F(Scripts, withoutExecuteAbort) {
  EXPECT_EQ(run_one("def exec(self): pass\n").error, "m: it has no execute(self, inputs, outputs, gvm)");
}

TEST_F(Scripts, seeTheErrorOfTheStateBefore) {
  const auto& result =
      run("mission: m\noutputs: {told: any}\nactions:\n" + action("a", execute("raise KeyError('k')")) +
          action("b",
                 execute("assert isinstance(inputs['error'], KeyError) and inputs['error'].args == ('k',)\n"
                         "outputs['told'] = inputs['error']\nreturn 0"),
                 "outputs: {told: text}") +
          "start: a\nflows: [b.told -> outputs.told]\nstates:\n  a: {on: {success: b, aborted: b}}\n"
          "  b: {on: {success: return success}}\n");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs.front(), Value("KeyError: 'k'"));
}

TEST_F(Scripts, seeAnEmptyErrorWhereTheStateBeforeReturnedAborted) {
  const auto& result =
      run("mission: m\noutputs: {told: any}\nactions:\n" + action("a", execute("return -1")) +
          action("b", execute("outputs['told'] = inputs['error']\nreturn 0"), "outputs: {told: any}") +
          "start: a\nflows: [b.told -> outputs.told]\nstates:\n"
          "  a: {on: {success: b, aborted: b}}\n  b: {on: {success: return success}}\n");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs.front(), Value(""));
}

// Values

TEST_F(Scripts, takeAndGiveValuesAsTheyAre) {
  const auto& result = run_body(
      "assert inputs == {'i': 3, 'f': 3.0, 'b': True, 't': 'ä', 'n': None, 'l': [1, [2.5]], 'm': {'a': {'b': "
      "[]}}}\n"
      "assert [type(v) for v in inputs.values()] == [int, float, bool, str, type(None), list, dict]\n"
      "outputs.update(inputs)\nreturn 0",
      "inputs: {i: {type: int, default: 3}, f: {type: float, default: 3.0}, b: {type: bool, default: true}, "
      "t: {type: text, default: ä}, n: any, l: {type: list, default: [1, [2.5]]}, "
      "m: {type: map, default: {a: {b: []}}}}\n"
      "outputs: {i: any, f: any, b: any, t: any, n: any, l: any, m: any}");
  ASSERT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs[0].kind(), Value::Kind::Int);
  EXPECT_EQ(result.outputs[1].kind(), Value::Kind::Float);
  EXPECT_EQ(result.outputs[2], Value(true));
  EXPECT_EQ(result.outputs[3], Value("ä"));
  EXPECT_TRUE(result.outputs[4].is_null());
  EXPECT_EQ(result.outputs[5], Value::list({1, Value::list({2.5})}));
  EXPECT_EQ(result.outputs[6], Value::map({{"a", Value::map({{"b", Value::List{}}})}}));
}

TEST_F(Scripts, giveTheNearestThatOtherTypesHave) {
  EXPECT_EQ(output_of("outputs['x'] = (1, 2)\nreturn 0"), Value::list({1, 2}));
  EXPECT_EQ(output_of("import enum\nclass E(enum.IntEnum):\n  A = 4\noutputs['x'] = E.A\nreturn 0"),
            Value(4));
  EXPECT_EQ(
      output_of("class Array:\n  def tolist(self): return [[1.5, 2]]\noutputs['x'] = Array()\nreturn 0"),
      Value::list({Value::list({1.5, 2})}));
  EXPECT_EQ(output_of("import collections\noutputs['x'] = collections.OrderedDict(a=1)\nreturn 0"),
            Value::map({{"a", 1}}));
  EXPECT_EQ(output_of("outputs['x'] = 2**64 - 1\nreturn 0"), Value(~std::uint64_t{0}));
}

TEST_F(Scripts, abortWithWhatCannotBePassedOn) {
  const auto error = [&](const std::string& value) {
    return error_of("outputs['x'] = " + value + "\nreturn 0", "outputs: {x: any}");
  };
  EXPECT_THAT(error("float('nan')"), HasSubstr("outputs['x']: nan cannot be passed on"));
  EXPECT_THAT(error("[0, {'a': float('inf')}]"), HasSubstr("outputs['x'][1]['a']: inf cannot be passed on"));
  EXPECT_THAT(error("2**64"), HasSubstr("does not fit into 64 bits"));
  EXPECT_THAT(error("{1: 2}"), HasSubstr("the key 1 is not a text"));
  EXPECT_THAT(error("{1, 2}"), HasSubstr("a value of type set cannot be passed on"));
  EXPECT_THAT(error("b'x'"), HasSubstr("type bytes"));
  EXPECT_THAT(error("'\\ud800'"), HasSubstr("not valid Unicode"));
  EXPECT_THAT(error_of("a = []\na.append(a)\noutputs['x'] = a\nreturn 0", "outputs: {x: any}"),
              HasSubstr("nested deeper"));
}

TEST_F(Scripts, haveDefaultsInOutputsAndMayOnlyWriteDeclaredOnes) {
  const auto& result = run_body("assert outputs == {'x': 5}\noutputs['y'] = 1\nreturn 0",
                                "outputs: {x: {type: int, default: 5}}");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs.front(), Value(5));
  EXPECT_THAT(lines_.text(), HasSubstr("warning m: outputs['y'] is not one of its outputs; ignored"));
}

TEST_F(Scripts, passOnMuch) {
  const Value text = output_of("outputs['x'] = 'ab' * 4_000_000\nreturn 0");
  ASSERT_TRUE(text.is_string());
  EXPECT_EQ(text.as_string().size(), 8'000'000U);
}

TEST_F(Scripts, abortWithMoreThanIsPossible) {
  options_.largest_message = 10'000;
  EXPECT_THAT(error_of("outputs['x'] = 'ab' * 10_000\nreturn 0", "outputs: {x: any}"),
              AllOf(HasSubstr("its outputs: "), HasSubstr("more than the 10000")));
  EXPECT_THAT(error_of("return 0", "inputs: {x: {type: text, default: " + std::string(20'000, 'a') + "}}"),
              AllOf(HasSubstr("its inputs: "), HasSubstr("more than the 10000")));
  EXPECT_EQ(run_body("return 0").outcome, 0);
}

TEST_F(Scripts, abortWithInputsThatJsonLacks) {
  EXPECT_THAT(error_of("return 0", "inputs: {x: {type: list, default: [1.0, .nan]}}"),
              HasSubstr("input 'x[1]' is infinite or not a number"));
}

// self

TEST_F(Scripts, knowTheirState) {
  const auto& result =
      run("mission: m\nactions:\n" +
          action("a",
                 execute("assert self.name == 'The first'\nassert self.state_id == 'one'\n"
                         "assert self.get_path() == 'one'\nassert self.run_id.endswith('%020d' % 1)\n"
                         "assert self.outcomes[1].name == 'bad' and self.outcomes[-1].outcome_id == -1\n"
                         "assert not self.preempted and not self.paused and self.started\nreturn 'good'"),
                 "outcomes: [good, bad]") +
          "start: one\nstates:\n  one: {title: The first, action: a, on: {good: return success, bad: return "
          "success}}\n");
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, areToldByNameWhatTheirStateDoesNotHave) {
  EXPECT_THAT(error_of("self.scoped_data\nreturn 0"),
              HasSubstr("AttributeError: scripts have no self.scoped_data"));
  EXPECT_THAT(error_of("self.preempted = True\nreturn 0"), HasSubstr("AttributeError"));
}

TEST_F(Scripts, seeWhatTheirStateIsGiven) {
  const auto& result = run_body(
      "assert self.input_data is inputs and self.output_data is outputs\n"
      "assert self.description == '' and self.semantic_data == {} and not self.backward_execution\n"
      "assert self.is_root_state\nself.own = 1\nassert self.own == 1\ndel self.own\n"
      "assert not hasattr(self, 'own')\nreturn 0");
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, printAndLogLinesThatNameTheState) {
  run_body(
      "import logging, os, sys\nself.logger.info('to %s', 'log')\nself.logger.verbose('much')\n"
      "print('one'); print('two', end='')\nsys.stderr.write('three\\n')\nlogging.error('four')\n"
      "os.write(1, b'five\\n')\nsys.stdout.buffer.write(b'six\\n'); sys.stdout.buffer.flush()\nreturn 0");
  for (const char* line :
       {"info m: to log\n", "debug m: much\n", "info m: one\n", "info m: two\n", "warning m: three\n",
        "error python: four\n", "info python: five\n", "info python: six\n"})
    EXPECT_TRUE(lines_.wait_for(line)) << line << lines_.text();
}

TEST_F(Scripts, mayPrintWithoutEnd) {
  run_body("import os\nfor i in range(20000): print('x' * 50)\nos.write(2, b'y' * 1000000)\nreturn 0");
  EXPECT_EQ(engine_->result().outcome, 0) << engine_->result().error;
  EXPECT_TRUE(lines_.wait_for("python: " + std::string(4096, 'y')));
}

TEST_F(Scripts, keepPersistentVariablesAndNothingElse) {
  const auto& result =
      run("mission: m\noutputs: {n: any, fresh: any}\nactions:\n" +
          action("a",
                 "n = 0\n" + execute("global n\nn += 1\nmemory = self.persistent_variables\n"
                                     "memory['n'] = memory.get('n', 0) + 1\noutputs['n'] = memory['n']\n"
                                     "outputs['fresh'] = n\nreturn 'again' if memory['n'] < 5 else 'done'"),
                 "outputs: {n: int, fresh: int}\noutcomes: [again, done]") +
          "start: a\nflows: [a.n -> outputs.n, a.fresh -> outputs.fresh]\n"
          "states:\n  a: {on: {again: a, done: return success}}\n");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs[0], Value(5));
  EXPECT_EQ(result.outputs[1], Value(1));
}

TEST_F(Scripts, ofFilesAreReadAgainWhenTheyChange) {
  write("helper.py", "NAME = 'helper'\n");
  write("a.py", "import helper\n" + execute("outputs['x'] = helper.NAME\nreturn 0"));
  const std::string mission =
      "mission: m\noutputs: {x: any}\nactions: {a: {outputs: {x: any}, run: {python: a.py}}}\naction: a\n";
  EXPECT_EQ(run(mission).outputs.at(0), Value("helper"));
  write("a.py", execute("outputs['x'] = 'changed'\nreturn 0"));
  EXPECT_EQ(run(mission).outputs.at(0), Value("changed"));
  write("a.py", execute("raise ValueError(1)"));
  EXPECT_EQ(run(mission).error, (folder_ / "a.py").string() + ":2: ValueError: 1");
  std::filesystem::remove(folder_ / "a.py");
  EXPECT_THAT(run(mission).error, AllOf(HasSubstr("a.py"), HasSubstr("FileNotFoundError")));
}

TEST_F(Scripts, areUndoneByBackwardExecute) {
  engine_options_.backward = true;
  load("mission: m\nactions:\n" +
       action(
           "a",
           execute("gvm.set_variable('n', inputs['x'])\nreturn 0") +
               "\ndef backward_execute(self, inputs, outputs, gvm):\n  gvm.set_variable('n', -inputs['x'])\n",
           "inputs: {x: {type: int, default: 4}}") +
       action("b", execute("return 0")) +
       "start: a\nstates:\n  a: {on: {success: b}}\n  b: {on: {success: return success}}\n");
  engine_->step_into();
  engine_->run();
  engine_->step_into();
  engine_->run();
  ASSERT_EQ(engine_->globals().get("n"), Value(4));
  ASSERT_TRUE(engine_->step_back());
  EXPECT_EQ(engine_->globals().get("n"), Value(-4));
}

// Preemption and pausing

TEST_F(Scripts, thatWaitArePreempted) {
  const auto& result =
      run("mission: m\nactions:\n" +
          action("quick",
                 execute("while not gvm.variable_exist('slow'): self.preemptive_wait(0.001)\nreturn 0")) +
          action("slow",
                 execute("assert self.preemptive_wait(0.001) is False\ngvm.set_variable('slow', 'waits')\n"
                         "assert self.preemptive_wait(600)\n"
                         "assert self.preempted and self.wait_for_interruption(600)\n"
                         "assert self.wait_for_unpause(600)\ngvm.set_variable('slow', 'ended')\nreturn 0")) +
          "kind: preemptive\nstates:\n  quick: {on: {success: return success}}\n"
          "  slow: {on: {success: return success}}\n");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(engine_->globals().get("slow"), Value("ended"));
}

TEST_F(Scripts, seeThatTheyArePaused) {
  load("mission: m\nactions:\n" +
       action("a", execute("self.logger.info('waits')\nassert self.wait_for_interruption(600)\n"
                           "assert self.paused and not self.started\nself.logger.info('paused')\n"
                           "assert self.wait_for_unpause(600)\nassert self.started\n"
                           "assert self.wait_for_interruption(0) is False\nreturn 0")) +
       "action: a\n");
  std::thread other([&] {
    EXPECT_TRUE(lines_.wait_for("waits"));
    runner_->set_paused(true);
    EXPECT_TRUE(lines_.wait_for("paused"));
    runner_->set_paused(false);
  });
  engine_->run();
  other.join();
  EXPECT_EQ(engine_->result().outcome, 0) << engine_->result().error;
}

TEST_F(Scripts, thatIgnorePreemptionAreKilled) {
  options_.preemption_grace = 50ms;
  load("mission: m\nactions:\n" +
       action("a", execute("import time\nself.logger.info('works')\nwhile True: time.sleep(0.01)")) +
       action("b", execute("return 0")) +
       "start: a\nstates:\n  a: {on: {success: b, preempted: b}}\n  b: {on: {success: return success}}\n");
  pid_t process = 0;
  std::thread other([&] {
    EXPECT_TRUE(lines_.wait_for("works"));
    process = runner_->process().value_or(0);
    engine_->stop();
  });
  engine_->run();
  other.join();
  EXPECT_EQ(engine_->result().outcome, kPreempted);
  EXPECT_EQ(engine_->history().items()[1].outcome, kPreempted);
  EXPECT_EQ(engine_->history().error(1), "the Python process was killed, since it ignored its preemption");
  ASSERT_NE(process, 0);
  EXPECT_TRUE(is_gone(process));
  EXPECT_EQ(run_body("return 0").outcome, 0);
}

TEST_F(Scripts, thatKeepTheInterpreterToThemselvesAreKilledInTheEnd) {
  engine_options_.preemption_grace = 50ms;
  load("mission: m\nactions:\n" + action("a", execute("import re\nself.logger.info('works')\n" + kHold)) +
       "action: a\n");
  std::thread other([&] {
    EXPECT_TRUE(lines_.wait_for("works"));
    engine_->stop();
  });
  engine_->run();
  other.join();
  const pid_t process = runner_->process().value_or(0);
  ASSERT_NE(process, 0);
  runner_.reset();
  engine_.reset();
  EXPECT_TRUE(is_gone(process));
}

TEST_F(Scripts, thatIgnorePreemptionGetNoCompany) {
  options_.preemption_grace = 1ms;
  engine_options_.preemption_grace = 1s;
  const std::string tell = "import os\ngvm.set_variable(self.name, os.getpid())\n";
  const auto& result =
      run("mission: m\nactions:\n" +
          action("quick", execute("while not gvm.variable_exist('stubborn'): pass\nreturn 0")) +
          action("stubborn", execute(tell + "while True: self.preemptive_wait(0.01)")) +
          action("after", execute(tell + "return 0")) +
          action("other", execute(tell + "while not gvm.variable_exist('after'): pass\nreturn 0")) +
          "  d: {run: {decide: [{outcome: success}]}}\n" +
          "kind: barrier\nstates:\n  other: {}\n  d: {kind: decider, on: {success: return success}}\n"
          "  left:\n    start: race\n    states:\n"
          "      after: {on: {success: return success}}\n"
          "      race:\n        kind: preemptive\n        on: {success: after}\n        states:\n"
          "          quick: {on: {success: return success}}\n"
          "          stubborn: {on: {success: return success}}\n");
  EXPECT_EQ(result.outcome, 0) << result.error;
  const auto process = [&](const std::string& name) {
    return static_cast<pid_t>(engine_->globals().get(name).value_or(Value(0)).as_int());
  };
  EXPECT_EQ(process("other"), process("stubborn"));
  EXPECT_NE(process("after"), process("stubborn"));
  EXPECT_TRUE(eventually([&] { return is_gone(process("stubborn")); }));
  EXPECT_FALSE(is_gone(process("after")));
}

TEST_F(Scripts, thatPrintWithoutEndArePreempted) {
  load("mission: m\nactions:\n" +
       action("a", execute("while not self.preempted: print('x' * 3000)\nreturn 0")) + "action: a\n");
  std::thread other([&] {
    EXPECT_TRUE(lines_.wait_for("xxx"));
    engine_->stop();
  });
  engine_->run();
  other.join();
  EXPECT_EQ(engine_->result().outcome, kPreempted);
  EXPECT_EQ(engine_->result().error, "");
}

// Side by side

std::string side_by_side(const std::string& actions, const std::string& decider = "") {
  return "mission: m\nactions:\n" + actions + action("d", execute(decider.empty() ? "return 0" : decider)) +
         "kind: barrier\nstates:\n  left: {title: Left hand}\n  right: {}\n"
         "  decide: {kind: decider, action: d, on: {success: return success}}\n";
}

TEST_F(Scripts, runSideBySide) {
  const auto meet = [](const std::string& mine, const std::string& other) {
    return execute("gvm.set_variable('" + mine + "', True)\nwhile not gvm.get_variable('" + other +
                   "', default=False):\n  if self.preemptive_wait(0.001): break\nreturn 0");
  };
  const auto& result = run(side_by_side(action("left", meet("l", "r")) + action("right", meet("r", "l"))));
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, ofDecidersKnowHowTheOthersEnded) {
  const auto& result =
      run(side_by_side(action("left", execute("return 'odd'"), "outcomes: [success, odd]") +
                           action("right", execute("raise RuntimeError('right fails')")),
                       "left = self.get_outcome_for_state_name('Left hand')\n"
                       "assert (left.name, left.outcome_id) == ('odd', 1)\n"
                       "assert self.get_outcome_for_state_name('left').name == 'odd'\n"
                       "assert self.get_outcome_for_state_id('right').outcome_id == -1\n"
                       "assert self.get_outcome_for_state_id('nobody') is None\n"
                       "assert 'right fails' in str(self.get_errors_for_state_name('right'))\n"
                       "assert 'right fails' in str(self.get_errors_for_state_id('right'))\n"
                       "assert self.get_errors_for_state_name('Left hand') is None\nreturn 0"));
  EXPECT_EQ(result.outcome, 0) << result.error;
}

// gvm

TEST_F(Scripts, useGlobalVariables) {
  run_body(
      "gvm.set_variable('a', {'x': [1, 2.5]})\nassert gvm.get_variable('a') == {'x': [1, 2.5]}\n"
      "assert gvm.get_variable('none') is None and gvm.get_variable('none', default=3) == 3\n"
      "gvm.set_variable('a', 'another type')\ngvm.set_variable('i', 1, data_type=int)\n"
      "for wrong in ('text', float('nan'), object()):\n"
      "  try: gvm.set_variable('i', wrong)\n  except (TypeError, ValueError): pass\n"
      "  else: raise AssertionError(wrong)\n"
      "try: gvm.set_variable('j', 'text', data_type=int)\nexcept TypeError: pass\nelse: assert False\n"
      "assert gvm.variable_exist('a') and not gvm.variable_exist('j')\n"
      "assert gvm.get_all_keys() == ['a', 'i'] and gvm.get_all_keys_starting_with('i') == ['i']\n"
      "assert gvm.get_all_variables()['i'] == 1\ngvm.delete_variable('a')\n"
      "gvm.set_variable('null', None)\nassert gvm.get_variable('null', default=1) is None\nreturn 0");
  EXPECT_EQ(engine_->result().outcome, 0) << engine_->result().error;
  EXPECT_EQ(engine_->globals().snapshot(), Value::map({{"i", 1}, {"null", Value()}}));
}

/// A script that does the first body, and then one that does the second.
std::string one_after_the_other(const std::string& first, const std::string& second,
                                const std::string& more = "") {
  return "mission: m\n" + more + "actions:\n" + action("first", execute(first + "\nreturn 0")) +
         action("second", execute(second + "\nreturn 0")) +
         "start: first\nstates:\n  first: {on: {success: second}}\n"
         "  second: {on: {success: return success}}\n";
}

TEST_F(Scripts, passLiveObjectsByReferenceToEachOther) {
  const auto& result = run(one_after_the_other(
      "import threading\nclass Node: pass\nnode = Node()\nnode.lock = threading.Lock()\nnode.topic = 'scan'\n"
      "gvm.set_variable('node', node, per_reference=True)",
      "gvm.set_variable('topic', gvm.get_variable('node', per_reference=True).topic)\n"
      "assert gvm.get_variable('node') is gvm.get_all_variables()['node']\n"
      "assert gvm.variable_can_be_referenced('node') and not gvm.variable_can_be_referenced('topic')\n"
      "try: gvm.get_variable('node', per_reference=False)\n"
      "except TypeError as error: assert 'Node cannot be copied' in str(error), error\n"
      "else: assert False"));
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(engine_->globals().snapshot(),
            Value::map({{"node", "an object of type Node"}, {"topic", "scan"}}));
}

TEST_F(Scripts, changeAListThatAVariableHoldsByReference) {
  const auto& result = run(one_after_the_other(
      "l = [1]\ngvm.set_variable('l', l, per_reference=True)\nl.append(2)",
      "gvm.get_variable('l', per_reference=True).append(3)\ngvm.get_variable('l').append(4)\n"
      "gvm.get_variable('l', per_reference=False).append('in a copy')"));
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(engine_->globals().get("l"), Value::list({1, 2, 3, 4}));
}

TEST_F(Scripts, getCopiesOfWhatWasSetByValue) {
  const auto& result = run(one_after_the_other(
      "l = [1]\ngvm.set_variable('l', l)\nl.append(2)\nt = ({1: 2}, float('inf'), {3})\n"
      "gvm.set_variable('t', t)\nt[0][1] = 'changed'",
      "assert gvm.get_variable('l') == [1], gvm.get_variable('l')\n"
      "assert gvm.get_variable('t') == ({1: 2}, float('inf'), {3}), gvm.get_variable('t')\n"
      "assert gvm.get_variable('t') is not gvm.get_variable('t')\n"
      "for key in ('l', 't'):\n  try: gvm.get_variable(key, per_reference=True)\n"
      "  except RuntimeError as error: assert 'not set by reference' in str(error)\n  else: assert False"));
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, putNoObjectOfAnotherTypeIntoAVariable) {
  const auto& result = run_body(
      "gvm.set_variable('i', 1, data_type=int)\n"
      "for wrong in (object(), [1], (1,)):\n"
      "  try: gvm.set_variable('i', wrong, per_reference=True)\n"
      "  except TypeError as error: assert 'is of type int' in str(error), error\n"
      "  else: raise AssertionError(wrong)\n"
      "gvm.set_variable('l', [1], per_reference=True, data_type=list)\nreturn 0");
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, loseNoObjectThatAVariableHoldsAndKeepNoOther) {
  const auto& result = run_body(
      "import gc, weakref\nclass Thing: pass\nseen = []\n"
      "for i in range(5):\n  thing = Thing()\n  seen.append(weakref.ref(thing))\n"
      "  gvm.set_variable('thing', thing, per_reference=True)\n  del thing\n"
      "  assert gvm.get_variable('thing') is seen[-1]()\ngc.collect()\n"
      "gvm.get_all_keys()\nassert [each() is None for each in seen] == [True] * 4 + [False], seen\nreturn 0");
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, areToldWhereAnObjectHasGoneWithItsProcess) {
  const auto& result =
      run("mission: m\nactions:\n" +
          action("first", execute("gvm.set_variable('l', [1], per_reference=True)\nreturn 0")) +
          action("dies", execute("import os; os._exit(3)")) +
          action("second", execute("gvm.get_variable('l')\nreturn 0")) +
          "start: first\nstates:\n  first: {on: {success: dies}}\n"
          "  dies: {on: {success: second, aborted: second}}\n"
          "  second: {on: {success: return success}}\n");
  EXPECT_EQ(result.outcome, kAborted);
  EXPECT_THAT(result.error,
              HasSubstr("'l' holds an object of another Python process, or of one that has ended"));
}

TEST_F(Scripts, haveAnInterpreterOfTheirOwnWhereTheyAreIsolated) {
  const std::string count = execute(
      "import builtins\nbuiltins.count = getattr(builtins, 'count', 0) + 1\noutputs['n'] = builtins.count\n"
      "return 0");
  std::string alone = action("alone", count, "outputs: {n: int}");
  alone.insert(alone.find("        text: |"), "        isolated: true\n");
  const auto& result =
      run("mission: m\noutputs: {shared: int, alone: int}\nactions:\n" +
          action("shared", count, "outputs: {n: int}") + alone +
          "start: a\nflows: [c.n -> outputs.shared, d.n -> outputs.alone]\nstates:\n"
          "  a: {action: shared, on: {success: b}}\n  b: {action: shared, on: {success: c}}\n"
          "  c: {action: shared, on: {success: d}}\n"
          "  d: {action: alone, on: {success: return success}}\n");
  ASSERT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs, (std::vector<Value>{3, 1}));
}

TEST_F(Scripts, nameGlobalVariablesByTheTextOfTheirKeys) {
  run_body(
      "gvm.set_variable(5, 1); gvm.set_variable(6, 2)\nassert gvm.get_variable('5') == 1\n"
      "key = gvm.lock_variable(6)\nassert gvm.is_locked('6')\ngvm.unlock_variable(6, key)\n"
      "assert gvm.variable_exist(6)\ngvm.delete_variable(6)\nreturn 0");
  EXPECT_EQ(engine_->result().outcome, 0) << engine_->result().error;
  EXPECT_EQ(engine_->globals().snapshot(), Value::map({{"5", 1}}));
}

TEST_F(Scripts, abortWhereTheyDeleteAVariableThatDoesNotExist) {
  EXPECT_EQ(error_of("gvm.delete_variable('nope')\nreturn 0"),
            "m:2: AttributeError: there is no global variable 'nope'");
}

TEST_F(Scripts, lockGlobalVariables) {
  run_body(
      "gvm.set_variable('v', 1)\nkey = gvm.lock_variable('v')\nassert key and gvm.is_locked('v')\n"
      "assert gvm.lock_variable('v') is False\n"
      "for access in (None, key + 1):\n"
      "  try: gvm.set_variable('v', 2, access_key=access)\n  except RuntimeError: pass\n"
      "  else: raise AssertionError(access)\n"
      "try: gvm.get_variable('v', access_key=key + 1)\nexcept RuntimeError: pass\nelse: assert False\n"
      "try: gvm.unlock_variable('v', key + 1)\nexcept RuntimeError: pass\nelse: assert False\n"
      "gvm.set_variable('v', 3, access_key=key)\nassert gvm.get_variable('v', access_key=key) == 3\n"
      "gvm.set_locked_variable('v', key, 4)\nassert gvm.get_locked_variable('v', key) == 4\n"
      "assert gvm.unlock_variable('v', key)\nassert not gvm.is_locked('v')\n"
      "key = gvm.lock_variable('v', block=True)\ngvm.unlock_variable('v', None, force=True)\nreturn 0");
  EXPECT_EQ(engine_->result().outcome, 0) << engine_->result().error;
}

TEST_F(Scripts, countTogetherUnderALock) {
  const std::string count = execute(
      "for i in range(50):\n  key = gvm.lock_variable('n', block=True)\n"
      "  n = gvm.get_variable('n', access_key=key)\n  gvm.set_variable('n', n + 1, access_key=key)\n"
      "  gvm.unlock_variable('n', key)\nreturn 0");
  const auto& result = run("globals: {n: {type: int, default: 0}}\n" +
                           side_by_side(action("left", count) + action("right", count)));
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(engine_->globals().get("n"), Value(100));
}

TEST_F(Scripts, thatWaitForALockArePreempted) {
  const auto& result = run(
      "mission: m\nactions:\n" +
      action("holder", execute("key = gvm.lock_variable('v')\nself.logger.info('holds')\n"
                               "while not gvm.variable_exist('waits'): pass\nreturn 0")) +
      action("waiter", execute("while not gvm.variable_exist('v'): pass\ngvm.set_variable('waits', True)\n"
                               "key = gvm.lock_variable('v', block=True)\n"
                               "if key is not False: gvm.unlock_variable('v', key)\nreturn 0")) +
      "kind: preemptive\nstates:\n  holder: {on: {success: return success}}\n"
      "  waiter: {on: {success: return success}}\n");
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, cannotUseGlobalVariablesOnceTheyHaveEnded) {
  const auto& result = run(
      "mission: m\nactions:\n" +
      action(
          "a",
          execute("import threading, builtins\n"
                  "def later():\n  builtins.ended.wait(600)\n"
                  "  try: gvm.get_variable('v')\n"
                  "  except RuntimeError as error: print('refused:', error)\n"
                  "builtins.ended = threading.Event()\nthreading.Thread(target=later).start()\nreturn 0")) +
      action("b", execute("import builtins\nbuiltins.ended.set()\nreturn 0")) +
      "start: a\nstates:\n  a: {on: {success: b}}\n  b: {on: {success: return success}}\n");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_TRUE(lines_.wait_for("refused: global variables cannot be used after the end of execute()"));
}

// The process

TEST_F(Scripts, shareAProcessThatEndsWithTheRunner) {
  EXPECT_EQ(run_body("return 0").outcome, 0);
  const auto process = runner_->process();
  ASSERT_TRUE(process);
  EXPECT_EQ(run_body("import atexit\natexit.register(lambda: print('bye'))\nreturn 0").outcome, 0);
  EXPECT_EQ(runner_->process(), process);
  engine_.reset();
  runner_.reset();
  EXPECT_TRUE(is_gone(*process));
  EXPECT_THAT(lines_.text(), HasSubstr("bye"));
}

TEST_F(Scripts, abortWhereTheirProcessEnds) {
  EXPECT_EQ(error_of("import os\nos._exit(3)"), "the Python process ended with exit status 3");
  EXPECT_EQ(error_of("import os\nos.kill(os.getpid(), 9)\nself.preemptive_wait(600)"),
            "the Python process was killed by signal 9 (Killed)");
  EXPECT_THAT(error_of("import os\nos.write(2, b'out of luck\\n')\nos._exit(0)"),
              "the Python process ended with exit status 0; its last output: out of luck");
  EXPECT_THAT(error_of("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\nself.preemptive_wait(600)"),
              HasSubstr("the Python process was killed by signal 11 (Segmentation fault)"));
  EXPECT_EQ(run_body("return 0").outcome, 0);
}

TEST_F(Scripts, allAbortWhereTheirProcessEnds) {
  load(side_by_side(action("left", execute("gvm.lock_variable('v')\nself.logger.info('left works')\n"
                                           "self.preemptive_wait(600)\nreturn 0")) +
                        action("right", execute("self.logger.info('right works')\nself.preemptive_wait(600)\n"
                                                "return 0")),
                    "for name in ('left', 'right'):\n"
                    "  assert 'killed by signal 9' in str(self.get_errors_for_state_id(name))\n"
                    "assert gvm.lock_variable('v')\nreturn 0"));
  std::thread other([&] {
    EXPECT_TRUE(lines_.wait_for("left works") && lines_.wait_for("right works"));
    ::kill(runner_->process().value(), SIGKILL);
  });
  engine_->run();
  other.join();
  EXPECT_EQ(engine_->result().outcome, 0) << engine_->result().error;
}

TEST_F(Scripts, abortWhereTheirProcessTalksNonsense) {
  EXPECT_THAT(error_of("import os, time\nos.write(3, b'hello, engine')\nwhile True: time.sleep(1)"),
              StartsWith("the Python process was killed, since it sent an invalid message: a message of "));
  EXPECT_THAT(error_of("import os, time\nos.write(3, b'\\x02\\0\\0\\0{]')\nwhile True: time.sleep(1)"),
              StartsWith("the Python process was killed, since it sent an invalid message: "));
  EXPECT_THAT(error_of("import os, time\nos.write(3, b'\\x02\\0\\0\\0{}')\nwhile True: time.sleep(1)"),
              StartsWith("the Python process was killed, since it sent an unknown message"));
  EXPECT_THAT(
      error_of("import os, time\nos.write(3, b'\\x0c\\0\\0\\0{\"do\":\"end\"}')\nwhile True: time.sleep(1)"),
      HasSubstr("it ended an execution that it had not been given"));
  EXPECT_EQ(run_body("return 0").outcome, 0);
}

TEST_F(Scripts, abortWhereTheirProcessClosesItsConnection) {
  EXPECT_EQ(error_of("import os, socket\nsocket.socket(fileno=os.dup(3)).shutdown(socket.SHUT_WR)\n"
                     "self.preemptive_wait(600)"),
            "the Python process ended with exit status 0");
}

TEST_F(Scripts, abortWhereTheirProcessClosesItsConnectionAndGoesOn) {
  write("worker.py", "import os, time\nos.close(3)\ntime.sleep(600)\n");
  options_.worker = folder_ / "worker.py";
  EXPECT_EQ(error_of("return 0"), "the Python process was killed, since it had closed its connection");
}

TEST_F(Scripts, mayForkProcessesThatOnlyCompute) {
  const auto& result = run_body(
      "import os\nreader, writer = os.pipe()\npid = os.fork()\nif pid == 0:\n"
      "  try: gvm.set_variable('v', 1)\n  except RuntimeError: os.write(writer, b'refused')\n  os._exit(0)\n"
      "assert os.read(reader, 100) == b'refused'\nos.waitpid(pid, 0)\nreturn 0");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(engine_->globals().get("v"), std::nullopt);
}

/// A script that starts a process in a session of its own and stores its pid as 'p'.
std::string starting_session(const std::string& options, const std::string& rest) {
  return "import os, subprocess\nchild = subprocess.Popen(['sleep', '600'], start_new_session=True" +
         options + ")\ngvm.set_variable('p', child.pid)\n" + rest;
}

TEST_F(Scripts, leaveNoProcessBehind) {
  const std::string plain =
      "import subprocess\ngvm.set_variable('p', subprocess.Popen(['sleep', '600']).pid)\nreturn 0";
  for (const std::string& body :
       {plain, starting_session("", "return 0"), starting_session(", env={}", "return 0"),
        starting_session("", "os._exit(1)"),
        starting_session("", "os.kill(os.getpid(), 9)\nself.preemptive_wait(600)")}) {
    (void)run_body(body);
    const auto child = static_cast<pid_t>(engine_->globals().get("p")->as_int());
    engine_.reset();
    runner_.reset();
    // It is the system's then, which may take a while to look after it.
    EXPECT_TRUE(eventually([&] {
      std::ifstream status("/proc/" + std::to_string(child) + "/stat");
      std::string number, name, state;
      return !(status >> number >> name >> state) || state == "Z";
    })) << body;
    ::kill(child, SIGKILL);
  }
}

TEST_F(Scripts, leaveNoProcessBehindWhenTheyAreKilled) {
  engine_options_.preemption_grace = 1ms;
  load("mission: m\nactions:\n" +
       action("a", execute(starting_session(", env={}", "self.logger.info('works')\nwhile True: pass"))) +
       "action: a\n");
  std::thread other([&] {
    EXPECT_TRUE(lines_.wait_for("works"));
    engine_->stop();
  });
  engine_->run();
  other.join();
  const auto child = static_cast<pid_t>(engine_->globals().get("p")->as_int());
  engine_.reset();
  runner_.reset();
  EXPECT_TRUE(eventually([&] { return is_gone(child); }));
}

TEST_F(Scripts, abortWhereTheyCloseTheConnection) {
  for (const std::string body : {"os.close(3)\nreturn 0", "os.closerange(3, 1000)\nreturn 0",
                                 "os.dup2(os.open('/dev/null', os.O_RDWR), 3)\nprint('x')\nreturn 0"})
    EXPECT_THAT(error_of("import os\n" + body), StartsWith("the Python process ")) << body;
  EXPECT_EQ(run_body("return 0").outcome, 0);
}

TEST_F(Scripts, sayWhereThereIsNoInterpreter) {
  for (const std::string python : {"/nowhere/python3", "no_such_python3"}) {
    options_.python = python;
    EXPECT_EQ(refusal(), "cannot find the Python interpreter '" + python +
                             "'; install python3, or name another interpreter");
  }
}

TEST_F(Scripts, sayWhereTheInterpreterIsNone) {
  options_.python = "false";
  EXPECT_EQ(error_of("return 0"), "the Python process ended with exit status 1");
}

TEST_F(Scripts, sayWhereTheWorkerIsNotThere) {
  options_.worker = "/nowhere/worker.py";
  EXPECT_EQ(refusal(), "the script worker '/nowhere/worker.py' is missing");
}

TEST_F(Scripts, mayOutliveTheirEngine) {
  engine_options_.preemption_grace = 1ms;
  load("mission: m\nactions:\n" +
       action("a", execute("self.logger.info('works')\n"
                           "while True: gvm.set_variable('n', 1)")) +
       "action: a\n");
  std::thread other([&] {
    EXPECT_TRUE(lines_.wait_for("works"));
    engine_->stop();
  });
  engine_->run();
  other.join();
  engine_.reset();
  EXPECT_EQ(run_body("return 0").outcome, 0);
}

// Data of the world

/// A mission that counts with functions in Python and then looks.
std::string counting(const std::string& functions, const std::string& more_states = "") {
  return "mission: m\nworld_data:\n  tally:\n    initial: {count: 0}\n    python:\n      text: |\n" +
         indented(functions, "        ") + "\n    effects: {'+done': add}\nactions:\n" +
         action("work", execute("return 0"), "inputs: {what: text}\neffects: ['+done({what})']") +
         action("die", execute("import os; os._exit(3)"), "resources: []") +
         action("look", execute("outputs['x'] = self.world.data['tally']\nreturn 0"),
                "reads_world: true\noutputs: {x: any}") +
         "start: work\noutputs: {x: any}\nflows: [look.x -> outputs.x]\nstates:\n"
         "  work: {inputs: {what: a}, on: {success: " +
         (more_states.empty() ? "look" : "first") + "}}\n" + more_states +
         "  look: {on: {success: return success}}\n";
}

TEST_F(Scripts, getDataThatFollowFactsAlsoAfterTheirProcessHasDied) {
  const auto& result = run(counting("def add(tally, what):\n  tally['count'] += 1\n  tally[what] = True",
                                    "  first: {action: look, on: {success: die}}\n"
                                    "  die: {on: {success: more, aborted: more}}\n"
                                    "  more: {action: work, inputs: {what: b}, on: {success: look}}\n"));
  ASSERT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs.front(), Value::map({{"count", 2}, {"a", true}, {"b", true}}));
}

TEST_F(Scripts, areToldWhyDataCannotBeComputed) {
  const std::string impatient = "import sys\nsys.modules['__main__'].EffectCalls.LONGEST = 0.2\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"def add(tally, what):\n  print('adds')\n  tally['nothing']",
       "the world data 'tally': world data tally:3: KeyError: 'nothing', in add for +done(a)"},
      {"x = 1", "world data tally: it has no function 'add', which +done(a) calls"},
      {"def add(tally):\n  pass", "takes 1 positional argument but 2 were given, in add for +done(a)"},
      {"def add(tally, what):\n  return {'x': [{1}]}",
       "after +done(a)['x'][0]: a value of type set cannot be passed on"},
      {"def add(tally, what):\n  return float('nan')", "nan cannot be passed on"},
      {"x = = 1", "SyntaxError: invalid syntax, in the script for +done(a)"},
      {"def add(tally, what):\n  raise SystemExit", "SystemExit, in add for +done(a)"},
      {"def add(tally, what):\n  import os\n  os._exit(3)", "the Python process"},
      {impatient + "def add(tally, what):\n  while True:\n    pass",
       "world data tally:4: add has not returned after 0.2 s, for +done(a)"},
      {impatient + "import time\nwhile True:\n  time.sleep(0.01)", "the script has not returned after 0.2 s"},
      {"def add(tally, what):\n  return 'x' * 70_000_000", "that can be passed at once"}};
  for (const auto& [functions, expected] : cases) {
    const auto& result = run(counting(functions));
    EXPECT_EQ(result.outcome, kAborted);
    EXPECT_THAT(result.error, HasSubstr(expected));
    EXPECT_TRUE(engine_->world().holds("done(a)")) << "nothing but the data is missing";
    runner_.reset();
  }
  EXPECT_THAT(lines_.text(), HasSubstr("info look: adds"));
}

TEST_F(Scripts, arePreemptedWhileTheyWaitForData) {
  load(
      counting("import time\ndef add(tally, what):\n  print('begins')\n  while True:\n    time.sleep(0.01)"));
  std::jthread running([this] { engine_->run(); });
  EXPECT_TRUE(lines_.wait_for("begins"));
  engine_->stop();
  running.join();
  EXPECT_EQ(engine_->result().outcome, kPreempted);
  EXPECT_THAT(lines_.text(), ::testing::Not(HasSubstr("ignored its preemption")));
}

/// Data with one function, for changes of "p", and facts that have none.
std::shared_ptr<WorldData> scripted_data() {
  DeclaredData declared{"d", Value(1), {"", "x = 1"}, {{"+p", "f", {}}}, {}};
  return std::make_shared<ScriptedData>(
      std::make_shared<const ScriptedData::Functions>(ScriptedData::Functions{declared, "m.yaml"}));
}

TEST(DataOfTheWorld, AreComputedInPiecesFromWhatIsKnown) {
  const auto data = scripted_data();
  const auto& scripted = dynamic_cast<const ScriptedData&>(*data);
  EXPECT_TRUE(scripted.next(10).changes.empty());
  for (const char* fact : {"p(1)", "q(1)", "p(2)", "p(3)"})
    data->changed(fact, true);
  data->changed("p(3)", false);
  const auto copy = data->clone();
  copy->changed("p(4)", true);
  const auto first = scripted.next(2);
  EXPECT_EQ(*first.base, Value(1));
  ASSERT_EQ(first.changes.size(), 2U) << "only those that have functions";
  EXPECT_EQ(first.changes[1].fact, "p(2)");
  EXPECT_FALSE(first.is_last);
  scripted.computed(first, Value(2));
  const auto rest = dynamic_cast<const ScriptedData&>(*copy).next(10);
  EXPECT_EQ(*rest.base, Value(2)) << "copies share what was computed before they came apart";
  EXPECT_EQ(rest.changes.size(), 2U);
  EXPECT_TRUE(rest.is_last);
  dynamic_cast<const ScriptedData&>(*copy).computed(rest, Value(3));
  EXPECT_EQ(*scripted.next(10).base, Value(2)) << "and nothing of what came then";
  scripted.computed(first, Value(7));
  EXPECT_EQ(*scripted.next(10).base, Value(2)) << "it was known";
}

TEST(DataOfTheWorld, MayHaveManyChangesThatNobodyLooksAt) {
  const auto data = scripted_data();
  for (int i = 0; i < 300'000; ++i)
    data->changed("p(" + std::to_string(i) + ")", true);
  const auto copy = data->clone();
  EXPECT_EQ(dynamic_cast<const ScriptedData&>(*copy).next(7).changes.size(), 7U);
}

}  // namespace
}  // namespace segue::mission
