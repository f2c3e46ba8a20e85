// SPDX-License-Identifier: Apache-2.0
//
// Runs whose journals are damaged in any way are refused, or go on and repeat nothing that may not be.
#include <segue/mission_engine/interrupted_journal.hpp>
#include <segue/mission_run/loaded_mission_test_support.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace segue::mission_run {
namespace {

using ::testing::HasSubstr;
using Times = std::map<std::string, int>;  ///< by the path of a state

/// Moves three times behind two looks, and twice more.
constexpr const char* kMoves = R"j(mission: m
actions:
  look: {pure: true, outputs: {n: int}, run: {callback: look}}
  move: {inputs: {n: int}, outcomes: [again, done], run: {callback: move}}
start: first
outcomes: [done]
flows: [first.n -> there.n, second.n -> back.n, second.n -> home.n]
states:
  first: {action: look, on: {success: there}}
  there: {action: move, on: {again: first, done: second}}
  second: {action: look, on: {success: back}}
  back: {action: move, on: {again: home, done: home}}
  home: {action: move, on: {again: return done, done: return done}}
)j";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    lines.push_back(text.substr(at, end - at));
    at = end;
  }
  return lines;
}

std::string joined_lines(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines)
    text += line;
  return text;
}

/// How often each action that may not be repeated had been carried out or begun: its entries in the journal
/// are whole.
Times moves_in(const std::string& journal) {
  Times times;
  for (const std::string& line : lines_of(journal)) {
    const std::string key = "\"begun\":\"";
    const auto at = line.find(key);
    const bool is_move = line.find("\"irreversible\":true") != std::string::npos && line.ends_with('\n');
    if (at == std::string::npos || !is_move) continue;
    const auto begin = at + key.size();
    ++times[line.substr(begin, line.find('"', begin) - begin)];
  }
  return times;
}

class DamagedJournals : public ::testing::TestWithParam<RunMode> {
 protected:
  DamagedJournals()
      : folder_(std::filesystem::temp_directory_path() / ("damaged_journals." + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    EXPECT_TRUE(write_file((folder_ / "m.yaml").string(), kMoves));
    plan_ = LoadedMission::load(folder_ / "m.yaml").value();
  }
  ~DamagedJournals() override { std::filesystem::remove_all(folder_); }

  Result<std::string> run(bool resume) {
    RunRequest request;
    request.mode = GetParam();
    request.clock = RunClock::Virtual;
    request.journal = Journal{file_};
    if (resume) request.journal->resume = mission::UnderWay::GoOn;
    request.note = [&](const std::string& text) { notes_ += text + "\n"; };
    request.runners.add("look", [](mission::ActionCall& call) {
      call.set_output("n", type::Value(2));
      return mission::Ending{};
    });
    request.runners.add("move", [&](mission::ActionCall& call) {
      const int time = ++moves_[call.path()];
      return mission::Ending{*call.outcome(call.path() == "there" && time < 3 ? "again" : "done"), {}};
    });
    const auto run = plan_->run(request);
    return run ? Result<std::string>((*run)->overview().outcome) : run.error();
  }
  /// The journal of a whole run.
  std::string journal_of_a_run() {
    std::filesystem::remove(file_);
    moves_.clear();
    EXPECT_EQ(run(false).value_or("refused"), "done");
    return read_file(file_).value();
  }
  /// Resumes a run that left `journal`, of which this is there. Moves that were begun count as carried out.
  Result<std::string> resume(const std::string& journal, const std::string& what_is_there) {
    EXPECT_TRUE(write_file(file_, what_is_there));
    moves_ = moves_in(journal);
    notes_.clear();
    return run(true);
  }

  const std::filesystem::path folder_;
  const std::filesystem::path file_ = folder_ / "journal";
  std::optional<LoadedMission> plan_;
  Times moves_;
  std::string notes_;
};

/// One kind of damage at a random place behind the first line.
std::string damaged(const std::string& text, const std::string& other, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return end == 0 ? 0 : random() % end; };
  auto lines = lines_of(text);
  const auto others = lines_of(other);
  const std::size_t line = below(lines.size());
  const auto from = lines.begin() + static_cast<std::ptrdiff_t>(line);
  std::string changed = text;
  switch (random() % 7) {
    case 0:
      return text.substr(0, below(text.size()));
    case 1:
      changed[below(text.size())] ^= static_cast<char>(1U << below(7));
      return changed;
    case 2:  // a line of another run
      *from = others[std::min(line, others.size() - 1)];
      return joined_lines(lines);
    case 3:  // the rest of another run
      lines.erase(from, lines.end());
      lines.insert(lines.end(), others.begin() + static_cast<std::ptrdiff_t>(std::min(line, others.size())),
                   others.end());
      return joined_lines(lines);
    case 4:  // lines that come twice
      lines.insert(from, lines[below(lines.size())]);
      return joined_lines(lines);
    case 5:  // its last line or two
      return text.substr(0, text.size() - std::min(below(200), text.size()));
    default:
      lines.erase(
          from, from + static_cast<std::ptrdiff_t>(1 + below(std::min<std::size_t>(3, lines.size() - line))));
      return joined_lines(lines);
  }
}

TEST_P(DamagedJournals, NeverLeadToAMoveThatIsMadeTwice) {
  const std::string other = journal_of_a_run();
  const std::string whole = journal_of_a_run();
  const Times expected = moves_;
  ASSERT_EQ(expected, (Times{{"there", 3}, {"back", 1}, {"home", 1}}));
  int refused = 0;
  int went_on = 0;
  int cut = 0;
  for (unsigned seed = 0; seed < 300 && !HasFailure(); ++seed) {
    std::mt19937 random(seed);
    const std::string left = mission::interrupted_journal(whole, whole.size() - random() % 1200);
    std::string there = damaged(left, other, random);
    if (seed % 4 == 0) there = damaged(there, other, random);
    SCOPED_TRACE("seed " + std::to_string(seed) + "\n" + there);
    const auto outcome = resume(left, there);
    for (const auto& [path, times] : moves_)
      EXPECT_LE(times, expected.at(path)) << path << (outcome ? "" : outcome.error().message);
    EXPECT_TRUE(outcome ? moves_ == expected : !outcome.error().message.empty());
    ++(outcome ? went_on : refused);
    cut += notes_.find("cut off") == std::string::npos ? 0 : 1;
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(went_on, 5);
  EXPECT_GT(cut, 5);
}

TEST_P(DamagedJournals, AreRefusedWithWhatIsKnownWhereALineInTheirMiddleIsLost) {
  const std::string whole = journal_of_a_run();
  auto lines = lines_of(whole);
  const auto ended = std::ranges::find_if(
      lines, [](const std::string& line) { return line.find("\"ended\":\"second\"") != std::string::npos; });
  ASSERT_NE(ended, lines.end());
  const auto number = ended - lines.begin() - 1;
  lines.erase(ended);
  const auto outcome = resume(whole, joined_lines(lines));
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().message, HasSubstr("entry " + std::to_string(number) + " is missing"));
  EXPECT_THAT(outcome.error().message, HasSubstr("the last of them 'there'"));
}

TEST_P(DamagedJournals, AreCutAtTheLastGoodEntryAndThatIsSaid) {
  const std::string whole = journal_of_a_run();
  const auto last = whole.find("\"ended\":\"second\"");
  ASSERT_NE(last, std::string::npos);
  const std::string left = mission::interrupted_journal(whole, whole.find('\n', last) + 1);
  const auto entries = std::ranges::count(left, '\n') - 3;
  const auto outcome = resume(left, left.substr(0, left.size() - 5));
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(moves_, (Times{{"there", 3}, {"back", 1}, {"home", 1}}));
  EXPECT_THAT(notes_, HasSubstr("1 line behind entry " + std::to_string(entries) + " was cut off"));
}

TEST_P(DamagedJournals, AreRefusedWhereTheirEndMayHaveToldOfAMove) {
  const std::string whole = journal_of_a_run();
  const auto last = whole.find("\"begun\":\"home\"");
  ASSERT_NE(last, std::string::npos);
  const std::string left = mission::interrupted_journal(whole, whole.find('\n', last) + 1);
  const auto outcome = resume(left, left.substr(0, left.rfind('\n', left.size() - 2) + 1));
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().message, HasSubstr("is missing at its end"));
  EXPECT_EQ(moves_, moves_in(left));
}

INSTANTIATE_TEST_SUITE_P(Modes, DamagedJournals, ::testing::ValuesIn(kBothModes), name_of_mode);

}  // namespace
}  // namespace segue::mission_run
