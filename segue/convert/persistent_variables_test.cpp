// SPDX-License-Identifier: Apache-2.0
//
// Executions of a script pass their persistent variables on to the next execution of the same state, as data
// flows do: also those that run ahead.
#include <segue/convert/test_support.hpp>
#include <segue/mission_engine/engine.hpp>
#include <segue/mission_script/script_runner.hpp>
#include <segue/type/json.hpp>
#include <support/kept_numbers.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <string_view>

namespace segue::convert {
namespace {

using ::testing::ElementsAre;
using testing::program;
using testing::VirtualRun;
using type::Value;

/// Stands for a script that counts its executions, by which it ends with the first outcome until the `most`th
/// one. Each takes a second.
class Counting final : public mission::ActionRunner {
 public:
  explicit Counting(std::uint64_t most) : most_(most) {}
  std::optional<mission::Ending> start(mission::ActionCall& call) override {
    kept_.update();
    std::uint64_t from = 0;
    const std::uint64_t count = kept_.before(call, from).value_or(0) + 1;
    mission::Ending ending;
    ending.outcome = count >= most_ && call.action().outcomes.size() > 1 ? 1 : 0;
    kept_.leave(call, from, count, ending);
    call.set_output("n", count);
    call.end_after(std::chrono::seconds(1), ending);
    return std::nullopt;
  }

 private:
  const std::uint64_t most_;
  KeptNumbers kept_;
};

VirtualRun counting(const std::string& text, std::uint64_t most) {
  mission::Runners runners;
  runners.set_scripts(std::make_shared<Counting>(most));
  return VirtualRun(text, {}, runners);
}

constexpr std::string_view kRemembers = R"({python: {text: "self.persistent_variables"}})";
/// Its value is that of the data flow, which is why it needs none of the above.
constexpr std::string_view kFollows = R"({simulated: {duration: 1s, outputs: {n: 1}}})";

/// Rounds in which a robot looks and then goes. Looking takes what it has found before from a data flow, or
/// from its persistent variables.
std::string patrol(std::string_view look, std::string_view flow) {
  return fmt::format(R"x(
mission: patrol
actions:
  look: {{pure: true, inputs: {{before: {{type: int, default: 0}}}}, outputs: {{n: int}}, run: {}}}
  go:
    inputs: {{n: int}}
    effects: ["+gone()"]
    resources: [{{block: base}}]
    outcomes: [more, enough]
    run: {{simulated: {{duration: 1s, outcomes: [more, more, more, enough]}}}}
outputs: {{n: int}}
start: look
flows: [look.n -> go.n, look.n -> outputs.n{}]
states:
  look: {{on: {{success: go}}}}
  go: {{on: {{more: look, enough: return success}}}}
)x",
                     look, flow);
}

TEST(PersistentVariables, LetALoopRunAheadAsDataFlowsDo) {
  const VirtualRun with_flow(patrol(kFollows, ", look.n -> look.before"));
  const VirtualRun remembering = counting(patrol(kRemembers, ""), 0);
  EXPECT_THAT(remembering.executions(),
              ElementsAre("look: success, 0 to 1", "go: more, 1 to 2", "look: success, 1 to 2",
                          "go: more, 2 to 3", "look: success, 2 to 3", "go: more, 3 to 4",
                          "look: success, 3 to 4", "go: enough, 4 to 5"));
  EXPECT_EQ(remembering.executions(), with_flow.executions());
  EXPECT_EQ(remembering.result.outputs.at(0), Value(4));
  EXPECT_EQ(remembering.network_result().statistics.repeated, 0U);
}

/// Going takes longer than a round, but all rounds go somewhere else. The next one begins once `look` has
/// said that there is one, which does not take until everything before it has ended.
TEST(PersistentVariables, CountBeforeAllThatComesBeforeHasEnded) {
  const std::string text = fmt::format(R"x(
mission: errands
actions:
  look: {{pure: true, outputs: {{n: int}}, outcomes: [more, enough], run: {}}}
  go:
    inputs: {{n: int}}
    effects: ["+sent({{n}})"]
    run: {{simulated: {{duration: 9s}}}}
start: look
flows: [look.n -> go.n]
states:
  look: {{on: {{more: go, enough: return success}}}}
  go: {{on: {{success: look}}}}
)x",
                                       kRemembers);
  EXPECT_THAT(
      counting(text, 4).executions(),
      ElementsAre("look: more, 0 to 1", "go: success, 1 to 10", "look: more, 1 to 2", "go: success, 2 to 11",
                  "look: more, 2 to 3", "go: success, 3 to 12", "look: enough, 3 to 4"));
}

/// Nothing but its memory keeps an irreversible action from running beside itself.
TEST(PersistentVariables, OfIrreversibleScriptsKeepTheirExecutionsInOrder) {
  const std::string text = R"x(
mission: m
resources: {pen: {count: 2, commutes: true}}
actions:
  mark: {resources: [{block: pen}], run: RUN}
  again: {pure: true, outcomes: [more, enough], run: {simulated: {outcomes: [more, enough]}}}
start: mark
states:
  mark: {on: {success: again}}
  again: {on: {more: mark, enough: return success}}
)x";
  const auto with = [&](std::string_view run) {
    std::string made = text;
    return made.replace(made.find("RUN"), 3, run);
  };
  EXPECT_EQ(counting(with(kRemembers), 0).executions().at(2), "mark: success, 1 to 2");
  EXPECT_EQ(counting(with(R"({python: {text: "pass"}})"), 0).executions().at(2), "mark: success, 0 to 1");
}

/// A ring of scripts, whose results depend on what they have left before: each one's text is random.
class RandomRing {
 public:
  explicit RandomRing(std::uint64_t seed) : random_(seed) {}

  std::string text() {
    const std::size_t size = 2 + under(3);
    std::string actions;
    std::string states;
    std::string flows;
    std::string outputs;
    for (std::size_t i = 0; i < size; ++i) {
      actions += action(i);
      const auto state = [&](std::size_t n) { return n < size ? fmt::format("s{}", n) : "again"; };
      states += fmt::format("  s{}: {{on: {{ok: {}, no: {}}}}}\n", i, state(i + 1), state(i + 1 + under(2)));
      outputs += fmt::format("{}y{}: int", i == 0 ? "" : ", ", i);
      flows += fmt::format("  - s{0}.y -> outputs.y{0}\n  - s{1}.y -> s{0}.x\n", i, under(size));
    }
    return fmt::format(
        "mission: ring\nactions:\n{}"
        "  again: {{effects: [+done], outcomes: [more, enough], expect: {{outcome: {}}}, run: {{simulated: "
        "{{outcomes: [more, more, more, more, enough]}}}}}}\n"
        "outputs: {{{}}}\nstart: s0\nflows:\n{}states:\n{}"
        "  again: {{on: {{more: s0, enough: return success}}}}\n",
        actions, chance(50) ? "more" : "enough", outputs, flows, states);
  }

 private:
  std::uint64_t under(std::uint64_t limit) { return random_() % limit; }
  bool chance(int percent) { return under(100) < static_cast<std::uint64_t>(percent); }

  std::string action(std::size_t i) {
    const bool pure = chance(60);
    const std::string kind = pure ? "pure: true" : chance(30) ? "sensing: true" : "strict: false";
    const std::string reads = chance(40) ? ", reads_world: true" : "";
    const std::string expects = chance(60) ? fmt::format(", expect: {{outcome: {}}}", ends()) : "";
    return fmt::format(
        "  s{}:\n    {{{}, effects: [\"{}f{}\"]{}{}, inputs: {{x: {{type: int, default: 1}}}}, outputs: "
        "{{y: "
        "int}}, outcomes: [ok, no], run: {{python: {{text: \"{}\"}}}}}}\n",
        i, kind, chance(50) ? "+" : "-", under(2), reads, expects, script(!reads.empty()));
  }

  std::string_view ends() { return chance(50) ? "ok" : "no"; }

  std::string script(bool reads) {
    const bool attribute = chance(30);
    const std::string before = attribute ? "getattr(self, 'n', 5)" : "self.persistent_variables.get('n', 5)";
    const std::string after = attribute ? "self.n" : "self.persistent_variables['n']";
    return fmt::format(
        "def execute(self, inputs, outputs, gvm):\\n  n = ({} * 31 + inputs['x'] * 7 + {}{}) % 1009\\n"
        "  if n % 4:\\n    {} = n\\n  outputs['y'] = n\\n  return 'ok' if n % {} else 'no'",
        before, under(100), reads ? " + len(self.world)" : "", after, 2 + under(3));
  }

  std::mt19937_64 random_;
};

mission::Runners python() {
  mission::Runners runners;
  runners.set_scripts(std::make_shared<mission::ScriptRunner>());
  return runners;
}

std::string text_of(const mission::MissionResult& result) {
  return result.outcome_name + ' ' + result.error + ' ' +
         type::to_json(Value(Value::List(result.outputs.begin(), result.outputs.end())), -1);
}

std::string sequentially(const std::string& text) {
  auto engine = mission::Engine::create(program(text), python()).value();
  engine->run();
  return text_of(engine->result());
}

TEST(PersistentVariables, OfPythonScriptsAreThoseOfTheSequentialRun) {
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    const std::string text = RandomRing(seed).text();
    const std::string written = sequentially(text);
    const VirtualRun run(text, {}, python());
    ASSERT_EQ(text_of(run.result), written) << "seed " << seed << text;
  }
}

/// The runs of one process share it: the second one goes on with what the first one has left.
TEST(PersistentVariables, OfARunAreThereInTheNextOne) {
  const auto runners = python();
  const std::string text = R"(
mission: m
outputs: {n: int}
actions:
  look:
    pure: true
    outputs: {n: int}
    outcomes: [more, enough]
    run:
      python:
        text: |
          def execute(self, inputs, outputs, gvm):
            self.n = outputs['n'] = getattr(self, 'n', 0) + 1
            return 'more' if self.n % 3 else 'enough'
start: look
flows: [look.n -> outputs.n]
states:
  look: {on: {more: look, enough: return success}}
)";
  EXPECT_EQ(VirtualRun(text, {}, runners).result.outputs.at(0), Value(3));
  EXPECT_EQ(VirtualRun(text, {}, runners).result.outputs.at(0), Value(6));
}

/// The second execution ends the process, and with it what the first one has left.
TEST(PersistentVariables, AreLostWithTheirProcess) {
  const std::string text = R"(
mission: m
outputs: {n: int}
actions:
  look:
    pure: true
    inputs: {error: {type: text, default: ""}}
    outputs: {n: int}
    outcomes: [more, enough]
    run:
      python:
        text: |
          import os
          def execute(self, inputs, outputs, gvm):
            n = outputs['n'] = self.persistent_variables.get('n', 0) + 1
            self.persistent_variables['n'] = n
            if n == 2 and not str(inputs['error']):
              os._exit(3)
            return 'enough' if str(inputs['error']) else 'more'
start: look
flows: [look.n -> outputs.n]
states:
  look: {on: {more: look, enough: return success, aborted: look}}
)";
  const std::string written = sequentially(text);
  EXPECT_EQ(written, "success  [1]");
  EXPECT_EQ(text_of(VirtualRun(text, {}, python()).result), written);
}

}  // namespace
}  // namespace segue::convert
