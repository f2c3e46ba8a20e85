// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_script/test_support.hpp>

namespace segue::mission {
namespace {

TEST_F(Scripts, EndWithTheNumberOrTheNameOfAnOutcome) {
  EXPECT_EQ(run_body("return 1", "outcomes: [a, b]").outcome_name, "b");
  EXPECT_EQ(run_body("return 'b'", "outcomes: [a, b]").outcome_name, "b");
  EXPECT_EQ(run_body("return -2").outcome, kPreempted);
  EXPECT_THAT(error_of("return 'aborted'"), HasSubstr("returned 'aborted'"));
}

TEST_F(Scripts, AbortWhereTheyReturnNoOutcome) {
  EXPECT_EQ(error_of("pass"),
            "m: execute() returned None, which is none of its outcomes: 'success', 'aborted', "
            "'preempted'");
  EXPECT_THAT(error_of("return 7"), HasSubstr("returned 7,"));
  EXPECT_THAT(error_of("return 'sucess'"), HasSubstr("returned 'sucess',"));
  EXPECT_THAT(error_of("return [0]"), HasSubstr("returned [0],"));
}

TEST_F(Scripts, ThatRaiseAbortWithTheErrorAndItsPlace) {
  const auto& result = run_one("def helper():\n  raise ValueError('no box')\n" + execute("helper()"));
  EXPECT_EQ(result.outcome, kAborted);
  EXPECT_EQ(result.error, "m:2: ValueError: no box");
  EXPECT_THAT(lines_.text(), HasSubstr("raise ValueError('no box')"));
  EXPECT_EQ(error_of("import sys; sys.exit(3)"), "m:2: SystemExit: 3");
  EXPECT_EQ(error_of("import json; json.loads('{')").substr(0, 22), "m:2: json.decoder.JSON");
}

TEST_F(Scripts, ThatCannotBeCompiledSayWhere) {
  EXPECT_THAT(run_one("def execute(self, inputs, outputs, gvm):\n  return 0\n  x = = 1\n").error,
              StartsWith("m:3: SyntaxError: "));
  EXPECT_THAT(run_one("x = 1 / 0\n").error, StartsWith("m:1: ZeroDivisionError"));
}

TEST_F(Scripts, WithoutExecuteAbort) {
  EXPECT_EQ(run_one("def exec(self): pass\n").error, "m: it has no execute(self, inputs, outputs, gvm)");
}

TEST_F(Scripts, SeeTheErrorOfTheStateBefore) {
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

TEST_F(Scripts, SeeAnEmptyErrorWhereTheStateBeforeReturnedAborted) {
  const auto& result =
      run("mission: m\noutputs: {told: any}\nactions:\n" + action("a", execute("return -1")) +
          action("b", execute("outputs['told'] = inputs['error']\nreturn 0"), "outputs: {told: any}") +
          "start: a\nflows: [b.told -> outputs.told]\nstates:\n"
          "  a: {on: {success: b, aborted: b}}\n  b: {on: {success: return success}}\n");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs.front(), Value(""));
}

// Values

TEST_F(Scripts, TakeAndGiveValuesAsTheyAre) {
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

TEST_F(Scripts, GiveTheNearestThatOtherTypesHave) {
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

TEST_F(Scripts, AbortWithWhatCannotBePassedOn) {
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

TEST_F(Scripts, HaveDefaultsInOutputsAndMayOnlyWriteDeclaredOnes) {
  const auto& result = run_body("assert outputs == {'x': 5}\noutputs['y'] = 1\nreturn 0",
                                "outputs: {x: {type: int, default: 5}}");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs.front(), Value(5));
  EXPECT_THAT(lines_.text(), HasSubstr("warning m: outputs['y'] is not one of its outputs; ignored"));
}

TEST_F(Scripts, PassOnMuch) {
  const Value text = output_of("outputs['x'] = 'ab' * 4_000_000\nreturn 0");
  ASSERT_TRUE(text.is_string());
  EXPECT_EQ(text.as_string().size(), 8'000'000U);
}

TEST_F(Scripts, AbortWithMoreThanIsPossible) {
  options_.largest_message = 10'000;
  EXPECT_THAT(error_of("outputs['x'] = 'ab' * 10_000\nreturn 0", "outputs: {x: any}"),
              AllOf(HasSubstr("its outputs: "), HasSubstr("more than the 10000")));
  EXPECT_THAT(error_of("return 0", "inputs: {x: {type: text, default: " + std::string(20'000, 'a') + "}}"),
              AllOf(HasSubstr("its inputs: "), HasSubstr("more than the 10000")));
  EXPECT_EQ(run_body("return 0").outcome, 0);
}

TEST_F(Scripts, AbortWithInputsThatJsonLacks) {
  EXPECT_THAT(error_of("return 0", "inputs: {x: {type: list, default: [1.0, .nan]}}"),
              HasSubstr("input 'x[1]' is infinite or not a number"));
}

// self

TEST_F(Scripts, KnowTheirState) {
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

TEST_F(Scripts, AreToldByNameWhatTheirStateDoesNotHave) {
  EXPECT_THAT(error_of("self.scoped_data\nreturn 0"),
              HasSubstr("AttributeError: scripts have no self.scoped_data"));
  EXPECT_THAT(error_of("self.preempted = True\nreturn 0"), HasSubstr("AttributeError"));
}

TEST_F(Scripts, SeeWhatTheirStateIsGiven) {
  const auto& result = run_body(
      "assert self.input_data is inputs and self.output_data is outputs\n"
      "assert self.description == '' and self.semantic_data == {} and not self.backward_execution\n"
      "assert self.is_root_state\nself.own = 1\nassert self.own == 1\ndel self.own\n"
      "assert not hasattr(self, 'own')\nreturn 0");
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, PrintAndLogLinesThatNameTheState) {
  run_body(
      "import logging, os, sys\nself.logger.info('to %s', 'log')\nself.logger.verbose('much')\n"
      "print('one'); print('two', end='')\nsys.stderr.write('three\\n')\nlogging.error('four')\n"
      "os.write(1, b'five\\n')\nsys.stdout.buffer.write(b'six\\n'); sys.stdout.buffer.flush()\nreturn 0");
  for (const char* line :
       {"info m: to log\n", "debug m: much\n", "info m: one\n", "info m: two\n", "warning m: three\n",
        "error python: four\n", "info python: five\n", "info python: six\n"})
    EXPECT_TRUE(lines_.wait_for(line)) << line << lines_.text();
}

TEST_F(Scripts, MayPrintWithoutEnd) {
  run_body("import os\nfor i in range(20000): print('x' * 50)\nos.write(2, b'y' * 1000000)\nreturn 0");
  EXPECT_EQ(engine_->result().outcome, 0) << engine_->result().error;
  EXPECT_TRUE(lines_.wait_for("python: " + std::string(4096, 'y')));
}

TEST_F(Scripts, KeepPersistentVariablesAndNothingElse) {
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

TEST_F(Scripts, OfFilesAreReadAgainWhenTheyChange) {
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

TEST_F(Scripts, AreUndoneByBackwardExecute) {
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

TEST_F(Scripts, ThatWaitArePreempted) {
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

TEST_F(Scripts, SeeThatTheyArePaused) {
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

TEST_F(Scripts, ThatIgnorePreemptionAreKilled) {
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

TEST_F(Scripts, ThatKeepTheInterpreterToThemselvesAreKilledInTheEnd) {
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

TEST_F(Scripts, ThatIgnorePreemptionGetNoCompany) {
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

TEST_F(Scripts, ThatPrintWithoutEndArePreempted) {
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

TEST_F(Scripts, GetDataThatFollowFactsAlsoAfterTheirProcessHasDied) {
  const auto& result = run(counting("def add(tally, what):\n  tally['count'] += 1\n  tally[what] = True",
                                    "  first: {action: look, on: {success: die}}\n"
                                    "  die: {on: {success: more, aborted: more}}\n"
                                    "  more: {action: work, inputs: {what: b}, on: {success: look}}\n"));
  ASSERT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs.front(), Value::map({{"count", 2}, {"a", true}, {"b", true}}));
}

TEST_F(Scripts, AreToldWhyDataCannotBeComputed) {
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

TEST_F(Scripts, ArePreemptedWhileTheyWaitForData) {
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
