// SPDX-License-Identifier: Apache-2.0
// The semantics that scripts and missions take over from RAFCON, in sequential and concurrent runs alike.
#include <segue/convert/concurrent_run.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_script/script_runner.hpp>
#include <segue/rafcon/rafcon.hpp>
#include <segue/type/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace segue::convert {
namespace {

using ::testing::HasSubstr;
using type::Value;

/// Ends with success unless it says otherwise.
std::string python(const std::string& body) {
  std::string text = "{python: {text: \"def execute(self, inputs, outputs, gvm):\\n";
  for (const char c : "  " + body + "\nreturn 'success'") {
    if (c == '"') text += '\\';
    text += c == '\n' ? "\\n  " : std::string(1, c);
  }
  return text + "\"}}";
}

enum class Mode { AsWritten, Concurrently };

class RafconSemantics : public ::testing::TestWithParam<Mode> {
 protected:
  const mission::MissionResult& run(const std::string& text) {
    Diagnostics diagnostics;
    auto mission = mission::read_mission(text, "/folder/m.yaml", diagnostics);
    EXPECT_TRUE(mission) << to_string(diagnostics) << text;
    program_ = mission::Program::compile(std::move(*mission)).value();
    return run();
  }
  const mission::MissionResult& run() {
    mission::Runners runners;
    runners.set_scripts(std::make_shared<mission::ScriptRunner>());
    if (GetParam() == Mode::AsWritten) {
      const auto engine = mission::Engine::create(program_, runners).value();
      engine->run();
      result_ = engine->result();
    } else {
      result_ = Run::create(program_, runners, {}).value()->run();
    }
    return result_;
  }
  [[nodiscard]] std::string output(std::size_t i = 0) const {
    return type::to_json(result_.outputs.at(i), -1);
  }

  std::shared_ptr<const mission::Program> program_;
  mission::MissionResult result_;
};
INSTANTIATE_TEST_SUITE_P(Runs, RafconSemantics, ::testing::Values(Mode::AsWritten, Mode::Concurrently),
                         [](const auto& one) {
                           return one.param == Mode::AsWritten ? "AsWritten" : "Concurrently";
                         });

TEST_P(RafconSemantics, DecidersGetTheErrorThatWasRaisedAndNoneForAnAbortThatWasReturned) {
  run(R"(
mission: m
actions:
  raises: {run: )" +
      python("class OwnError(ValueError): pass\nraise OwnError('no box', 7)") + R"(}
  returns: {run: )" +
      python("return -1") + R"(}
  looks: {outputs: {seen: any}, run: )" +
      python("raised = self.get_errors_for_state_name('raises')\n"
             "outputs['seen'] = [type(raised).__name__, isinstance(raised, ValueError), list(raised.args),\n"
             "  self.get_errors_for_state_name('returns'), "
             "self.get_outcome_for_state_name('returns').outcome_id]") +
      R"(}
kind: barrier
outputs: {seen: any}
flows: [looks.seen -> outputs.seen]
states:
  raises: {}
  returns: {}
  looks: {kind: decider, on: {success: return success}}
)");
  EXPECT_EQ(result_.outcome, 0) << result_.error;
  EXPECT_EQ(output(), R"(["OwnError",true,["no box",7],null,-1])");
}

TEST_P(RafconSemantics, OutputsThatWereWrittenBeforeAScriptFailsCount) {
  for (const std::string end : {"raise ValueError('x')", "return 'no such outcome'", "return -1"}) {
    run(R"(
mission: m
actions:
  a: {outputs: {x: {type: any, default: 1}, y: {type: any, default: 2}}, run: )" +
        python("outputs['x'] = 5\n" + end) + R"(}
outputs: {x: any, y: any}
start: a
flows: [a.x -> outputs.x, a.y -> outputs.y]
states:
  a: {on: {success: return success, aborted: return success}}
)");
    EXPECT_EQ(result_.outcome, 0) << result_.error;
    EXPECT_EQ(output(0), "5") << end;
    EXPECT_EQ(output(1), "2") << end;
  }
}

TEST_P(RafconSemantics, PathsByNameAreOfTitlesInAnyAlphabet) {
  run(R"(
mission: m
actions:
  look: {outputs: {seen: any}, run: )" +
      python("outputs['seen'] = [self.get_path(by_name=True), self.get_path(), "
             "self.parent.get_path(by_name=True)]") +
      R"(}
outputs: {seen: any}
start: outer
flows: [outer.seen -> outputs.seen]
states:
  outer:
    title: Äußere
    outputs: {seen: any}
    start: look
    flows: [look.seen -> outputs.seen]
    states: {look: {title: 日本語, on: {success: return success}}}
    on: {success: return success}
)");
  EXPECT_EQ(result_.outcome, 0) << result_.error;
  EXPECT_EQ(output(), R"(["m/Äußere/日本語","outer/look","m/Äußere"])");
}

TEST_P(RafconSemantics, AttributesThatAScriptSetsOfItsStateStayForItsNextExecution) {
  run(R"(
mission: m
actions:
  count: {outputs: {n: int}, outcomes: [success, again], run: )" +
      python("self.n = getattr(self, 'n', 0) + 1\noutputs['n'] = self.n\n"
             "if self.n < 3: return 'again'") +
      R"(}
outputs: {n: int}
start: count
flows: [count.n -> outputs.n]
states:
  count: {on: {success: return success, again: count}}
)");
  EXPECT_EQ(result_.outcome, 0) << result_.error;
  EXPECT_EQ(output(), "3");
}

TEST_P(RafconSemantics, PortsOfTypeTupleGiveScriptsTuples) {
  run(R"(
mission: m
actions:
  first: {outputs: {pose: {type: tuple, default: [1, 2]}}, run: )" +
      python("outputs['pose'] = outputs['pose'] + (3,)") + R"(}
  second: {inputs: {pose: tuple}, outputs: {ends: any}, run: )" +
      python("outputs['ends'] = [type(inputs['pose']).__name__, inputs['pose'] + (4,)]") + R"(}
outputs: {ends: any}
start: first
flows: [first.pose -> second.pose, second.ends -> outputs.ends]
states:
  first: {on: {success: second}}
  second: {on: {success: return success}}
)");
  EXPECT_EQ(result_.outcome, 0) << result_.error;
  EXPECT_EQ(output(), R"(["tuple",[1,2,3,4]])");
}

TEST_P(RafconSemantics, ScriptsKnowTheStatesAroundThem) {
  run(R"(
mission: m
actions:
  look: {outputs: {seen: any}, run: )" +
      python("states = []\n"
             "state = self.parent\n"
             "while state is not self.get_state_machine():\n"
             "  states.append([state.name, state.state_id, state.get_path()])\n"
             "  state = state.parent\n"
             "machine = self.get_state_machine()\n"
             "outputs['seen'] = [states, machine.name, machine.file_system_path, machine.root_state.name]") +
      R"(}
libraries:
  tools:
    outputs: {seen: any}
    start: look
    flows: [look.seen -> outputs.seen]
    states: {look: {on: {success: return success}}}
outputs: {seen: any}
start: outer
flows: [outer.seen -> outputs.seen]
states:
  outer:
    title: Outer one
    outputs: {seen: any}
    start: uses
    flows: [uses.seen -> outputs.seen]
    states: {uses: {id: USESAA, library: tools, on: {success: return success}}}
    on: {success: return success}
)");
  EXPECT_EQ(result_.outcome, 0) << result_.error;
  EXPECT_EQ(output(), R"([[["tools","tools","outer/uses"],["uses","USESAA","outer/uses"],)"
                      R"(["Outer one","outer","outer"],["m","m",""]],"m","/folder","m"])");
}

}  // namespace
}  // namespace segue::convert
