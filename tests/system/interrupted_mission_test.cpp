// SPDX-License-Identifier: Apache-2.0
// Missions that command a robot are killed, or lose it, and are resumed. SEGUE_INTERRUPTED_MISSIONS=50 kills
// as many in each mode.
#include <support/number_from.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>

#include "system_test.hpp"
#include "two_goals.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

/// Its robot runs on at the end.
const std::string kInterrupted = std::string(kTwoGoals) + "at_end: keep\n";

/// Runs a mission that is killed, and resumed.
class InterruptedMission : public SystemTest {
 protected:
  [[nodiscard]] std::string journal() const {
    std::ifstream file(folder_ / "journal");
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] int count(const std::string& what) const {
    const std::string text = journal();
    int found = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
      ++found;
    return found;
  }

  std::vector<std::string> next_command(const std::string& mode, bool resume) {
    std::vector<std::string> line = {"mission", "run", "drive.yaml", "--mode", mode, "--journal", "journal"};
    if (resume) line.emplace_back("--resume");
    return command(std::move(line));
  }

  /// How many entries the journal of an undisturbed run has before its last action is told what to do, from
  /// when on the robot drives for a while.
  std::size_t entries_before_the_last_drive(const std::string& mode) {
    const auto finished = run(next_command(mode, false), folder_);
    EXPECT_EQ(finished.status, 0) << finished.output << finished.errors;
    const std::string text = journal();
    const auto told = text.rfind(R"("stage":"told")");
    EXPECT_NE(told, std::string::npos) << text;
    std::filesystem::remove(folder_ / "journal");
    return static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<long>(told), '\n'));
  }
  /// Whether a mission was killed before its end, as soon as its journal had that many entries.
  bool run_killed_after(std::size_t entries, const std::string& mode) {
    Process mission(next_command(mode, false), folder_);
    EXPECT_TRUE(eventually([&] { return count("\n") >= static_cast<int>(entries); })) << journal();
    mission.signal(SIGKILL);
    return mission.wait().status == 128 + SIGKILL && count(R"("finished")") == 0;
  }

  /// Resumes until the mission has ended, or is said to; what was interrupted while it was told is told
  /// again.
  bool resume_to_the_end(const std::string& mode) {
    bool again = false;
    Finished last;
    const bool has_ended = eventually([&] {
      const bool exists = journal().find('\n') != std::string::npos;
      if (!exists) std::filesystem::remove(folder_ / "journal");
      auto line = next_command(mode, exists);
      if (again && exists) line.insert(line.end(), {"--under-way", "again"});
      last = run(line, folder_);
      again = last.errors.find("was being told what to do") != std::string::npos;
      told_again_ += again ? 1 : 0;
      return last.status == 0 || last.errors.find("that run has ended") != std::string::npos;
    });
    EXPECT_TRUE(has_ended) << last.output << last.errors;
    return has_ended;
  }

  int told_again_ = 0;  ///< actions that were interrupted while they were told
};

TEST_F(InterruptedMission, GoesOnWithoutTellingAnActionTwice) {
  start();
  write("drive.yaml", kInterrupted);
  const int rounds = number_from("SEGUE_INTERRUPTED_MISSIONS", 2);
  std::mt19937 random(std::random_device{}());
  std::map<std::string, std::size_t> entries;
  for (const std::string mode : {"sequential", "concurrent"})
    entries[mode] = entries_before_the_last_drive(mode);
  int killed = 0;
  for (int round = 0; round < 2 * rounds; ++round) {
    const std::string mode = round % 2 == 0 ? "sequential" : "concurrent";
    const std::size_t at = random() % (entries[mode] + 1);
    SCOPED_TRACE(mode + ", killed after " + std::to_string(at) + " entries of its journal");
    told_again_ = 0;
    killed += run_killed_after(at, mode) ? 1 : 0;
    EXPECT_TRUE(resume_to_the_end(mode));
    EXPECT_EQ(count(R"("finished":"done")"), 1) << journal();
    EXPECT_LE(count(R"("stage":"told")"), 2 + told_again_) << journal();
    EXPECT_EQ(count(R"("ended":"first")"), 1) << journal();
    EXPECT_EQ(segue({"switch", "-"}).status, 0);
    std::filesystem::remove(folder_ / "journal");
  }
  EXPECT_GE(killed, rounds) << "missions end before they are killed";
}

/// Which adopts tasks in processes of their own, and knows their controller by what runs.
TEST_F(InterruptedMission, GoesOnWithTheNextRuntime) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  std::ofstream(folder_ / "rover/controllers/go_to.yaml", std::ios::app)
      << "deployments: {motion: {tasks: [drive, odometry, laser, guard, seeker]}}\n";
  write("drive.yaml", kInterrupted);
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    start();
    std::filesystem::remove(folder_ / "journal");
    Process mission(next_command(mode, false), folder_);
    ASSERT_TRUE(eventually([&] { return count(R"("stage":"told")") > 0; })) << journal();
    robot_->signal(SIGKILL);
    robot_->wait();
    const auto finished = mission.wait();
    EXPECT_EQ(finished.status, 1) << finished.output << finished.errors;
    EXPECT_THAT(finished.errors, HasSubstr("the robot cannot be reached any more"));
    start();
    EXPECT_TRUE(resume_to_the_end(mode));
    EXPECT_EQ(count(R"("finished":"done")"), 1) << journal();
    EXPECT_EQ(count(R"("stage":"told")"), 2) << journal();
    stop();
  }
}

}  // namespace
}  // namespace segue::testing
