// SPDX-License-Identifier: Apache-2.0
// The guarantee: a mission that runs concurrently does what it does sequentially. Random missions with
// branches, loops, hierarchies, barriers, aborts and their handlers, data flows and variables, whose actions
// answer by what they read. SEGUE_MISSION_CASES tries more, SEGUE_MISSION_SEED begins elsewhere.
#include <segue/convert/run.hpp>
#include <segue/mission/files.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>

namespace segue::convert {
namespace {

using mission::Ending;
using type::Value;

std::uint64_t setting(const char* name, std::uint64_t fallback) {
  const char* given = std::getenv(name);
  return given == nullptr ? fallback : std::strtoull(given, nullptr, 10);
}

/// A mission file out of a number.
class RandomMission {
 public:
  explicit RandomMission(std::uint64_t seed) : random_(seed) {}

  std::string text() {
    const std::string root = container(0, "", true);
    const std::string world = chance(50) ? "world: [f0, g(1), g(4), b1]\n" : "";
    return "mission: random\nresources: {r0: {count: 2}}\n" + world + "actions:\n" + actions_ +
           "inputs: {in: {type: int, default: 7}}\n" + root;
  }

 private:
  std::uint64_t under(std::uint64_t limit) { return random_() % limit; }
  bool chance(int percent) { return under(100) < static_cast<std::uint64_t>(percent); }

  /// What an action relies on and changes. States side by side have facts of their own: what one of them does
  /// to a fact of another is a race, which either run may decide otherwise.
  std::string facts(std::string_view own) {
    const auto fact = [&] {
      if (!own.empty()) return std::string(own);
      return chance(40) ? std::string("g({x})") : fmt::format("f{}", under(3));
    };
    std::string text;
    if (chance(80)) text += fmt::format("    effects: [\"{}{}\"]\n", chance(60) ? "+" : "-", fact());
    if (chance(20)) text += fmt::format("    preconditions: [\"{}{}\"]\n", chance(50) ? "!" : "", fact());
    return text;
  }

  /// An action of its own for each leaf. `back`: it may first lead back. `own`: the only fact that it
  /// touches.
  std::string action(bool back, bool branches, std::string_view own = "") {
    const std::string name = fmt::format("a{}", count_++);
    std::string text = fmt::format("  {}:\n    inputs: {{x: {{type: int, default: {}}}}}\n", name, under(9));
    text += "    outputs: {y: {type: int, default: 0}}\n";
    text += branches || back ? "    outcomes: [ok, no]\n" : "    outcomes: [ok]\n";
    if (chance(50)) text += "    pure: true\n";
    if (chance(70)) text += facts(own);
    if (chance(30)) text += fmt::format("    resources: [{{block: r0, count: {}}}]\n", 1 + under(2));
    if (chance(50)) text += fmt::format("    expect: {{duration: {}s, outcome: ok}}\n", under(4));
    if (back) {
      const std::string first = chance(30) ? "no, no" : chance(30) ? "no, ok, no" : "no";
      text +=
          fmt::format("    run: {{simulated: {{duration: {}s, outcomes: [{}, ok], outputs: {{y: {}}}}}}}\n",
                      under(4), first, under(9));
    } else {
      text += "    run: {callback: mix}\n";
    }
    actions_ += text;
    return name;
  }

  /// The keys of a hierarchy with everything in it.
  std::string container(int depth, const std::string& indent, bool root) {
    const std::size_t size = 2 + under(4);
    std::string states;
    std::string flows;
    const auto target = [&](std::size_t i) {
      if (i >= size) return std::string(chance(70) ? "return done" : "return other");
      return fmt::format("s{}", i);
    };
    for (std::size_t i = 0; i < size; ++i) {
      states += fmt::format("{}  s{}:\n", indent, i);
      const std::string inner = indent + "    ";
      const bool nested = depth < 2 && chance(25);
      const bool barrier = nested && chance(40);
      std::string outcomes;
      if (barrier) {
        states += beside(depth + 1, inner);
        outcomes = fmt::format("done: {}", target(i + 1));
      } else if (nested) {
        states += container(depth + 1, inner, false);
        outcomes = fmt::format("done: {}, other: {}", target(i + 1), target(i + 1 + under(2)));
      } else {
        const bool back = chance(25);
        const bool two = chance(40);
        states += fmt::format("{}action: {}\n", inner, action(back, two));
        outcomes = fmt::format("ok: {}", target(i + 1));
        if (back)
          outcomes += fmt::format(", no: s{}", under(i + 1));
        else if (two)
          outcomes += fmt::format(", no: {}", target(i + 1 + under(3)));
      }
      if (chance(25)) outcomes += fmt::format(", aborted: {}", target(i + 1 + under(2)));
      states += fmt::format("{}on: {{{}}}\n", inner, outcomes);
      flows += flows_of(i, size, indent);
    }
    std::string text;
    if (!root) text += indent + "inputs: {in: {type: int, default: 3}}\n";
    text += indent + "outputs: {out: {type: int, default: 1}}\n";
    text += indent + "variables: {v: {type: int, default: 5}}\n";
    text += indent + "outcomes: [done, other]\n" + indent + "start: s0\n";
    text += indent + "flows:\n" + flows + indent + "states:\n" + states;
    nested_.clear();
    return text;
  }

  std::string flows_of(std::size_t i, std::size_t size, const std::string& indent) {
    // Ports of leaves are x and y, those of containers in and out; which it is shows in the text that is
    // read back, so both are written and what does not fit is left out by `fit`.
    (void)size;
    std::string text;
    const auto line = [&](const std::string& from, const std::string& to) {
      text += fmt::format("{}  - {} -> {}\n", indent, from, to);
    };
    if (chance(40)) line(fmt::format("s{}.OUT", i), "variables.v");
    if (chance(40)) line("variables.v", fmt::format("s{}.IN", i));
    if (chance(30)) line("inputs.in", fmt::format("s{}.IN", i));
    if (i > 0 && chance(50)) line(fmt::format("s{}.OUT", under(i)), fmt::format("s{}.IN", i));
    if (i == 0 || chance(30)) line(fmt::format("s{}.OUT", i), "outputs.out");
    return text;
  }

  std::string beside(int depth, const std::string& indent) {
    (void)depth;
    const std::size_t size = 2 + under(2);
    std::string states;
    std::string flows;
    for (std::size_t i = 0; i < size; ++i) {
      states += fmt::format("{}  s{}:\n{}    action: {}\n", indent, i, indent,
                            action(false, chance(40), fmt::format("b{}", i)));
      if (chance(60)) flows += fmt::format("{}  - inputs.in -> s{}.IN\n", indent, i);
      if (chance(60)) flows += fmt::format("{}  - s{}.OUT -> outputs.out\n", indent, i);
    }
    const std::string decider = fmt::format("d{}", count_++);
    actions_ += fmt::format("  {}:\n    outcomes: [ok]\n    run: {{decide: [{{outcome: ok}}]}}\n", decider);
    states += fmt::format(
        "{0}  decider:\n{0}    kind: decider\n{0}    action: {1}\n{0}    on: {{ok: return done}}\n", indent,
        decider);
    return fmt::format(
               "{0}kind: barrier\n{0}inputs: {{in: {{type: int, default: 3}}}}\n"
               "{0}outputs: {{out: {{type: int, default: 1}}}}\n{0}outcomes: [done]\n",
               indent) +
           (flows.empty() ? "" : indent + "flows:\n" + flows) + indent + "states:\n" + states;
  }

  std::mt19937_64 random_;
  std::string actions_;
  std::vector<bool> nested_;
  int count_ = 0;
};

std::uint64_t mixed(std::string_view path, std::int64_t number) {
  std::uint64_t hash = 1469598103934665603ULL ^ static_cast<std::uint64_t>(number);
  for (const char c : path)
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash ^ (hash >> 29);
}

using Happened = std::map<std::string, std::vector<std::string>>;

mission::Runners runners() {
  class Mix final : public mission::ActionRunner {
   public:
    std::optional<Ending> start(mission::Call& call) override {
      const Value& x = call.input("x");
      const std::uint64_t hash = mixed(call.path(), x.is_integer() ? x.as_int() : -1);
      call.set_output("y", Value(static_cast<std::int64_t>(hash % 100)));
      Ending ending;
      ending.outcome = static_cast<mission::Outcome>((hash >> 8) % call.action().outcomes.size());
      if ((hash >> 16) % 10 == 0)
        ending = {mission::kAborted, fmt::format("failed at {}", x.is_integer() ? x.as_int() : -1)};
      call.end_after(std::chrono::seconds((hash >> 24) % 4), ending);
      return std::nullopt;
    }
  };
  mission::Runners made;
  made.add("mix", std::make_shared<Mix>());
  return made;
}

struct Ran {
  mission::MissionResult result;
  std::vector<std::string> world;
  Happened happened;
  std::vector<std::string> routines;  ///< what goes on within is not told
  Duration makespan{};
};

Ran sequential(const std::shared_ptr<const mission::Program>& program) {
  VirtualClock clock;
  mission::EngineOptions options;
  options.clock = &clock;
  auto engine = mission::Engine::create(program, runners(), options).value();
  const TimePoint begin = clock.now();
  engine->run();
  Ran ran;
  ran.result = engine->result();
  ran.makespan = clock.now() - begin;
  ran.world.assign(engine->world().facts().begin(), engine->world().facts().end());
  const auto& items = engine->history().items();
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    const auto kind = program->node(items[i].state).kind;
    if (kind != mission::StateKind::Execution && kind != mission::StateKind::Decider) continue;
    ran.happened[engine->history().path(*program, i)].push_back(
        program->outcome_name(items[i].state, items[i].outcome));
  }
  return ran;
}

Ran concurrent(const std::shared_ptr<const mission::Program>& program, RunOptions options) {
  auto run = Run::create(program, runners(), {}, options).value();
  Ran ran;
  ran.result = run->run();
  const cdtn::RunResult& result = run->network_result();
  ran.makespan = result.makespan;
  ran.world = result.world.texts(run->plan().network().facts);
  for (std::uint32_t i = 0; i < result.nodes.size(); ++i) {
    const cdtn::NodeId node{i};
    const auto status = result.nodes[i].status;
    if (run->plan()[node].role == Role::Routine)
      ran.routines.push_back(std::string(run->plan()[node].path) + "/");
    if (run->plan()[node].role != Role::Action) continue;
    if (status != cdtn::NodeStatus::Done && status != cdtn::NodeStatus::Failed) continue;
    const auto outcome = run->plan().outcome(node, result.nodes[i].outcome);
    ran.happened[std::string(run->plan()[node].path)].push_back(
        program->outcome_name(run->plan()[node].state, outcome));
  }
  return ran;
}

std::string text_of(const Happened& happened) {
  std::string text;
  for (const auto& [path, outcomes] : happened)
    text += fmt::format("  {}: {}\n", path, fmt::join(outcomes, ", "));
  return text;
}

std::string difference(Ran a, const Ran& b, bool strict) {
  std::erase_if(a.happened, [&](const auto& entry) {
    return std::ranges::any_of(b.routines, [&](const auto& path) { return entry.first.starts_with(path); });
  });
  if (a.result.outcome_name != b.result.outcome_name)
    return fmt::format("outcome {} ({}) instead of {} ({})", b.result.outcome_name, b.result.error,
                       a.result.outcome_name, a.result.error);
  if (a.result.outcome < 0 && a.result.error != b.result.error)
    return fmt::format("error '{}' instead of '{}'", b.result.error, a.result.error);
  // Where it fails, what comes later may have come about already, but for strict runs.
  if (a.world != b.world && (strict || a.result.outcome >= 0))
    return fmt::format("world {} instead of {}", fmt::join(b.world, " "), fmt::join(a.world, " "));
  if (a.result.outcome < 0) return {};
  if (a.happened != b.happened)
    return "what happened:\n" + text_of(b.happened) + " instead of\n" + text_of(a.happened);
  if (a.result.outputs != b.result.outputs)
    return fmt::format("outputs {} instead of {}", type::describe(b.result.outputs.at(0)),
                       type::describe(a.result.outputs.at(0)));
  return {};
}

/// "s1.OUT" stands for whatever the output of s1 is called: reads the file as a value first.
std::string fitted(std::string text);

TEST(MissionEquivalence, ConcurrentRunsDoWhatTheSequentialOneDoes) {
  const std::uint64_t first = setting("SEGUE_MISSION_SEED", 1);
  const std::uint64_t cases = setting("SEGUE_MISSION_CASES", 5000);
  std::size_t faster = 0;
  std::size_t succeeded = 0;
  for (std::uint64_t seed = first; seed < first + cases; ++seed) {
    const std::string text = fitted(RandomMission(seed).text());
    Diagnostics diagnostics;
    auto mission = mission::read_mission(text, "random.yaml", diagnostics);
    ASSERT_TRUE(mission) << text << to_string(diagnostics);
    auto program = mission::Program::compile(std::move(*mission));
    ASSERT_TRUE(program) << text << to_string(program.error());
    const Ran reference = sequential(*program);
    RunOptions options;
    options.clock = cdtn::ClockKind::Virtual;
    options.strict = seed % 2 == 0;
    const Ran ran = concurrent(*program, options);
    ASSERT_EQ(difference(reference, ran, options.strict), "") << text << "SEGUE_MISSION_SEED=" << seed;
    // The sequential engine runs barriers side by side whatever their actions do to each other.
    const bool comparable = !options.strict && text.find("barrier") == std::string::npos &&
                            text.find("block") == std::string::npos;
    EXPECT_TRUE(!comparable || ran.makespan <= reference.makespan) << text << "SEGUE_MISSION_SEED=" << seed;
    if (ran.makespan < reference.makespan) ++faster;
    if (reference.result.outcome >= 0) ++succeeded;
  }
  EXPECT_GT(faster, cases / 10);
  EXPECT_GT(succeeded, cases / 10);
}

std::string fitted(std::string text) {
  // A state is a container where its lines say what it holds.
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const auto end = text.find('\n', begin);
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  std::string result;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::string line = lines[i];
    const auto indent = line.find_first_not_of(' ');
    for (const auto& [mark, leaf, inside] : {std::tuple("OUT", "y", "out"), std::tuple("IN", "x", "in")}) {
      auto at = line.find(std::string(".") + mark);
      if (at == std::string::npos || indent == std::string::npos) continue;
      auto start = line.rfind('s', at);
      const std::string state = std::string(indent, ' ') + line.substr(start, at - start) + ":";
      bool is_leaf = false;
      for (std::size_t j = i; j < lines.size(); ++j) {
        if (lines[j] != state) continue;
        is_leaf = lines[j + 1].find("action:") != std::string::npos;
        break;
      }
      line.replace(at + 1, std::string_view(mark).size(), is_leaf ? leaf : inside);
    }
    result += line + "\n";
  }
  return result;
}

}  // namespace
}  // namespace segue::convert
