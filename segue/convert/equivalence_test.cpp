// SPDX-License-Identifier: Apache-2.0
// The guarantee: a mission that runs concurrently does what it does sequentially, under every disturbance:
// actions that end otherwise or take longer than expected, that abort, throw or lose their worker; loops,
// preemptions and their handlers; a stop at any moment, a crash after any line of the journal.
// SEGUE_MISSION_CASES tries more, SEGUE_MISSION_SEED begins elsewhere, SEGUE_MISSION_SHOW shows what
// happened. The same program with SEGUE_CONVERT_FAULTS plants faults into the conversion and expects to find
// each.
#include <segue/base/file.hpp>
#include <segue/convert/conversion_fault.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_engine/interrupted_journal.hpp>
#include <segue/type/json.hpp>
#include <support/check_mission.hpp>
#include <support/random_missions.hpp>
#include <support/sanitizers.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>

#include <unistd.h>

namespace segue::convert {
namespace {

std::uint64_t setting(const char* name, std::uint64_t fallback) {
  const char* given = std::getenv(name);
  return given == nullptr ? fallback : std::strtoull(given, nullptr, 10);
}

std::shared_ptr<const mission::Program> program_of(const std::string& text) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(text, "random.yaml", diagnostics);
  EXPECT_TRUE(mission) << text << to_string(diagnostics);
  auto program = mission::Program::compile(std::move(*mission));
  EXPECT_TRUE(program) << text << to_string(program.error());
  return *program;
}

RunOptions options_of(std::uint64_t seed) {
  RunOptions options;
  options.clock = task_network::ClockKind::Virtual;
  options.strict = seed % 2 == 0;
  options.speculate = seed % 16 != 5;
  options.workers = seed % 5 == 1 ? static_cast<std::uint32_t>(seed / 5 % 3 + 1) : 0;
  options.world_copies = seed % 6 == 3 ? static_cast<std::uint32_t>(seed / 6 % 2 + 1) : 0;
  options.ahead = seed % 11 == 4 ? static_cast<std::uint32_t>(seed / 11 % 2 + 1) : 0;
  options.least_likelihood = seed % 9 == 2 ? 0.3 : 0;
  options.horizon = seed % 7 == 2 ? 5 + seed / 7 % 20 : 1000;
  return options;
}

/// Prints both runs, for whoever looks for a fault.
void show(const Ran& written, const ConcurrentRun& run) {
  for (const auto& [path, outcomes] : written.happened)
    fmt::print("{}: {}\n", path, fmt::join(outcomes, ", "));
  fmt::print("sequential: {} {}, {}\n", written.result.outcome_name, written.result.error,
             written.makespan / std::chrono::seconds(1));
  const task_network::TaskNetwork& network = run.plan().network();
  const auto at = [](TimePoint time) { return time.time_since_epoch() / std::chrono::seconds(1); };
  for (std::uint32_t i = 0; i < network.size(); ++i) {
    const task_network::NodeResult& node = run.network_result().nodes[i];
    fmt::print("{}: status {}, outcome {}, {} to {}, counts at {}, {} runs\n",
               network.label(task_network::NodeId{i}), static_cast<int>(node.status),
               network.outcomes.name(static_cast<std::uint32_t>(node.outcome)), at(node.started),
               at(node.ended), at(node.committed), node.attempts);
  }
  for (std::uint32_t i = 0; i < network.size(); ++i) {
    if (const auto& outputs = run.network_result().outputs[i])
      fmt::print("{}: {}\n", network.label(task_network::NodeId{i}), type::to_json(*outputs, -1));
  }
  fmt::print("globals {} instead of {}\n", type::to_json(run.ran.globals, -1),
             type::to_json(written.globals, -1));
  fmt::print("by itself: {} {}\n", run.ran.result.outcome_name, run.ran.result.error);
}

struct Trial {
  std::string text;
  std::string difference;
  bool faster = false;
  bool succeeded = false;
  bool preempted = false;
  bool stopped = false;
  bool comparable = true;
  bool raced = false;
  bool ran_short = false;  ///< of units, and nothing handled that
  bool foreseen = false;   ///< a check finds a state to which that happens
  bool looked = false;     ///< a state of a preemptive container that was divided looks at all facts
};

bool looks_in_race(const MissionPlan& plan) {
  const auto races = [&](const mission::ParallelBranch* place) {
    while (place != nullptr && plan.program().node(plan.program().node(place->child).parent).kind !=
                                   mission::StateKind::Preemptive)
      place = place->around.get();
    return place != nullptr;
  };
  for (std::uint32_t i = 0; i < plan.network().size(); ++i) {
    const task_network::NodeId node{i};
    if (plan.network()[node].reads_world && !plan.network()[node].opaque && races(plan[node].branch.get()))
      return true;
  }
  return false;
}

/// The first irreversible action that was executed again although its end was recorded, or "".
std::string executed_again(const ConcurrentRun& resumed, const mission::RunJournal& journal) {
  std::map<std::string, std::size_t> left;  // by path: executions that the journal does not have
  resumed.for_each_action([&](task_network::NodeId node, const std::string&) {
    const PlannedNode& planned = resumed.plan()[node];
    if (resumed.plan().network()[node].kind != ActionClass::Irreversible) return;
    left[std::string(planned.path)] += journal.find({std::string(planned.path), 0, planned.loops}) ? 0 : 1;
  });
  for (const auto& [path, executions] : left) {
    if (resumed.begun_at(path) > executions) return path + " was executed again";
  }
  return {};
}

/// The first recorded execution that does not count in the resumed run, or "".
std::string forgotten(const ConcurrentRun& resumed, const mission::RunJournal& journal) {
  auto recorded = journal.executions();
  const auto& nodes = resumed.network_result().nodes;
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    const PlannedNode& planned = resumed.plan()[task_network::NodeId{i}];
    if (nodes[i].status == task_network::NodeStatus::Done ||
        nodes[i].status == task_network::NodeStatus::Preempted)
      recorded.erase({std::string(planned.path), 0, planned.loops});
  }
  return recorded.empty() ? "" : recorded.begin()->path + " was forgotten";
}

/// Runs the mission with a journal, and once more with what is left of that journal after a crash; the second
/// run must do what the mission does sequentially. Returns the difference, or "".
std::string difference_after_crash(const std::shared_ptr<const mission::Program>& program, const Ran& written,
                                   RunOptions options, std::uint64_t seed) {
  const auto file = std::filesystem::path(testing::TempDir()) / ("segue_crash_" + std::to_string(::getpid()));
  std::filesystem::remove(file);
  mission::RunJournal::Start start;
  start.concurrent = true;
  options.journal = mission::RunJournal::create(file, program->mission(), start).value();
  (void)ConcurrentRun(program, options);
  options.journal.reset();
  const std::string text = read_file(file).value();
  const auto lines = static_cast<std::uint64_t>(std::ranges::count(text, '\n'));
  std::size_t end = 0;
  for (std::uint64_t left = 2 + seed / 8 % (lines - 2); left > 0; --left)
    end = text.find('\n', end) + 1;
  EXPECT_TRUE(write_file(file, mission::interrupted_journal(text, end)));
  auto journal = mission::RunJournal::resume(file, program->mission(), true, mission::UnderWay::Again);
  if (!journal) return to_string(journal.error());
  options.journal = std::move(*journal);
  const ConcurrentRun resumed(program, options);
  MissionCheck check(written, resumed, options.strict);
  std::string difference = check.comparable() ? check.difference() : "";
  if (difference.empty() && resumed.ran.result.outcome >= 0)
    difference = executed_again(resumed, *options.journal) + forgotten(resumed, *options.journal);
  if (!difference.empty() && setting("SEGUE_MISSION_SHOW", 0) != 0) show(written, resumed);
  if (!difference.empty()) difference += ", resumed after\n" + text.substr(0, end);
  std::filesystem::remove(file);
  return difference;
}

/// The states of which a check says that they always abort since units run short.
std::vector<mission::StateIndex> foreseen_short(const mission::Mission& mission) {
  std::vector<mission::StateIndex> states;
  const Diagnostics diagnostics = mission::validate(mission);
  for (const Diagnostic& found : diagnostics.items()) {
    if (found.code != "runs-short") continue;
    for (mission::StateIndex i = 0; i < mission.states.size(); ++i) {
      const SourceLocation& place = mission.states[i].where;
      if (place.line == found.where.line && place.column == found.where.column) states.push_back(i);
    }
  }
  return states;
}

/// A state that did not abort although the check says so, or "".
std::string wrongly_foreseen(const std::vector<mission::StateIndex>& states, const mission::Mission& mission,
                             const Ran& written) {
  for (const mission::StateIndex state : states) {
    const auto ends = written.ends.find(state);
    if (ends != written.ends.end() && (ends->second.contains("ok") || ends->second.contains("no")))
      return mission.path(state) + " did not abort";
  }
  return {};
}

/// Runs the mission of that number sequentially, by itself, in some cases again after a crash, and once more
/// until it is stopped.
Trial attempt(std::uint64_t seed) {
  Trial trial;
  trial.text = RandomMission(seed).text();
  const auto program = program_of(trial.text);
  const Ran written = run_as_written(program);
  const RunOptions options = options_of(seed);
  const ConcurrentRun run(program, options);
  MissionCheck check(written, run, options.strict);
  trial.comparable = check.comparable();
  trial.raced = !run.plan().race_record().firsts.empty();
  if (!trial.comparable) return trial;
  trial.difference = check.difference();
  if (trial.difference.empty()) trial.difference = check.slower();
  const auto foreseen = foreseen_short(program->mission());
  if (trial.difference.empty()) trial.difference = wrongly_foreseen(foreseen, program->mission(), written);
  trial.foreseen = !foreseen.empty();
  const bool one_at_a_time = trial.text.find("kind: barrier") == std::string::npos &&
                             trial.text.find("kind: preemptive") == std::string::npos;
  if (trial.difference.empty() && one_at_a_time) trial.difference = check.slower_than_written();
  trial.looked = looks_in_race(run.plan());
  trial.faster = run.ran.makespan < written.makespan;
  trial.succeeded = written.result.outcome >= 0;
  trial.ran_short = written.result.error.starts_with("it needs ");
  trial.preempted = run.network_result().statistics.preempted > 0;
  if (!trial.difference.empty() && setting("SEGUE_MISSION_SHOW", 0) != 0) show(written, run);
  if (trial.difference.empty() && seed % 8 == 3)
    trial.difference = difference_after_crash(program, written, options, seed);
  if (!trial.difference.empty() || run.begun() == 0) return trial;
  const ConcurrentRun stopped(program, options, 1 + seed % run.begun());
  trial.stopped = stopped.ran.result.outcome == mission::kPreempted;
  trial.difference = MissionCheck(written, stopped, options.strict).difference_after_stop();
  if (!trial.difference.empty() && setting("SEGUE_MISSION_SHOW", 0) != 0) show(written, stopped);
  if (!trial.difference.empty()) trial.difference += ", stopped";
  return trial;
}

#ifndef SEGUE_CONVERT_FAULTS

/// The mission with milliseconds in place of seconds.
std::string quick(const std::string& text) {
  static const std::regex kSeconds("duration: ([0-9]+)s");
  return std::regex_replace(text, kSeconds, "duration: $1ms");
}

/// Here times are what the computer grants, so who wins a race does not matter.
TEST(MissionEquivalence, RunsInRealTimeDoWhatTheSequentialOneDoes) {
  const std::uint64_t first = setting("SEGUE_MISSION_SEED", 1);
  const std::uint64_t cases = setting("SEGUE_MISSION_CASES", kSanitized ? 150 : 10'000) / 100;
  std::size_t compared = 0;
  answer_second = std::chrono::milliseconds(1);
  for (std::uint64_t seed = first; compared < cases; ++seed) {
    const std::string text = quick(RandomMission(seed).text());
    if (text.find("kind: preemptive") != std::string::npos) continue;
    ++compared;
    const auto program = program_of(text);
    const Ran written = run_as_written(program);
    RunOptions options = options_of(seed);
    options.clock = task_network::ClockKind::Real;
    const ConcurrentRun run(program, options);
    const std::string difference = MissionCheck(written, run, options.strict).difference();
    if (!difference.empty() && setting("SEGUE_MISSION_SHOW", 0) != 0) show(written, run);
    ASSERT_EQ(difference, "") << text << "SEGUE_MISSION_SEED=" << seed;
  }
  answer_second = std::chrono::seconds(1);
}

TEST(MissionEquivalence, ConcurrentRunsDoWhatTheSequentialOneDoes) {
  const std::uint64_t first = setting("SEGUE_MISSION_SEED", 1);
  const std::uint64_t cases = setting("SEGUE_MISSION_CASES", kSanitized ? 150 : 10'000);
  std::size_t faster = 0;
  std::size_t succeeded = 0;
  std::size_t preempted = 0;
  std::size_t stopped = 0;
  std::size_t comparable = 0;
  std::size_t raced = 0;
  std::size_t ran_short = 0;
  std::size_t foreseen = 0;
  std::size_t looked = 0;
  for (std::uint64_t seed = first; seed < first + cases; ++seed) {
    const Trial trial = attempt(seed);
    ASSERT_EQ(trial.difference, "") << trial.text << "SEGUE_MISSION_SEED=" << seed;
    comparable += trial.comparable ? 1 : 0;
    raced += trial.comparable && trial.raced ? 1 : 0;
    faster += trial.faster ? 1 : 0;
    succeeded += trial.succeeded ? 1 : 0;
    preempted += trial.preempted ? 1 : 0;
    stopped += trial.stopped ? 1 : 0;
    ran_short += trial.ran_short ? 1 : 0;
    foreseen += trial.foreseen ? 1 : 0;
    looked += trial.looked ? 1 : 0;
  }
  if (cases < 1000) return;
  EXPECT_GT(comparable, cases * 9 / 10);
  EXPECT_GT(raced, cases / 100);
  EXPECT_GT(faster, cases / 10);
  EXPECT_GT(succeeded, cases / 10);
  EXPECT_GT(preempted, cases / 200);
  EXPECT_GT(stopped, cases / 4);
  EXPECT_GT(ran_short, cases / 50);
  EXPECT_GT(foreseen, cases / 200);
  EXPECT_GT(looked, cases / 500);
}

#else

class Planted : public testing::TestWithParam<int> {};

TEST_P(Planted, FaultsOfTheConversionAreFound) {
  constexpr std::uint64_t kCases = 10'000;  // as many as are tried without faults
  planted_fault = static_cast<ConversionFault>(GetParam());
  std::uint64_t seed = 1;
  while (seed < kCases && attempt(seed).difference.empty())
    ++seed;
  planted_fault = ConversionFault::None;
  EXPECT_LT(seed, kCases) << "this fault would go unnoticed";
}

INSTANTIATE_TEST_SUITE_P(All, Planted, testing::Range(1, static_cast<int>(ConversionFault::Last) + 1));

#endif

}  // namespace
}  // namespace segue::convert
