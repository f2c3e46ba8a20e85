// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/planner/planner_process.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>

#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

namespace segue::planner {
namespace {

using ::testing::HasSubstr;

PlannerCommand of(std::vector<std::string> words) {
  PlannerCommand command;
  command.words = std::move(words);
  return command;
}

/// The plan of a planner that is a script of the shell, or the error.
std::string planned_by(const std::string& script, PlannerCommand command = {},
                       const std::stop_token& stop = {}) {
  command.words = {"sh", "-c", script, "sh", "{domain}", "{problem}"};
  const auto plan = run_planner(command, "the domain", "the problem", stop);
  return plan ? *plan : std::string(to_string(plan.error().code)) + ": " + plan.error().message;
}

TEST(PlannerProcess, GetsDomainAndProblemAndPrintsThePlan) {
  EXPECT_EQ(planned_by("cat \"$1\"; echo; cat \"$2\"; echo unheard >&2"), "the domain\nthe problem");
}

TEST(PlannerProcess, MayWriteItsPlanIntoAFileTheLastOfWhichCounts) {
  const auto plan = [](const std::string& script) {
    const auto found = run_planner(of({"sh", "-c", script, "sh", "{plan}"}), "", "", {});
    return found ? *found : found.error().message;
  };
  EXPECT_EQ(plan("printf '(a)' > \"$1\"; echo much else; exit 3"), "(a)");
  EXPECT_EQ(plan("for i in 1 2 3; do printf \"(a$i)\" > \"$1.$i\"; done"), "(a3)");
  EXPECT_EQ(
      plan("echo Search stopped without finding a solution. >&2; exit 12"),
      "the planner ended with status 12 and without a plan; the last that it wrote: 'Search stopped without "
      "finding a solution.'");
}

TEST(PlannerProcess, ThatFindsNothingOrDiesIsReported) {
  EXPECT_EQ(planned_by("exit 0"), "not-found: the planner ended with status 0 and printed no plan");
  EXPECT_EQ(planned_by("echo '(half a plan'; exit 7"),
            "not-found: the planner ended with status 7; the last that it wrote: '(half a plan'");
  EXPECT_THAT(planned_by("echo begins; kill -SEGV $$"),
              HasSubstr("io-error: signal 11 (Segmentation fault) ended the planner; the last that it wrote: "
                        "'begins'"));
  const auto missing = run_planner(of({"no-such-planner"}), "", "", {});
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message,
              HasSubstr("the planner ended with status 127; the last that it wrote: "));
  EXPECT_THAT(missing.error().message, HasSubstr("no-such-planner: not found"));
  EXPECT_FALSE(run_planner({}, "", "", {}));
}

/// The process whose number a script has written; it is gone, or not ours any more.
bool is_gone(const std::filesystem::path& file) {
  pid_t process = 0;
  std::ifstream(file) >> process;
  EXPECT_GT(process, 0);
  return segue::testing::eventually([&] {
    std::ifstream status("/proc/" + std::to_string(process) + "/stat");
    std::string number;
    std::string name;
    std::string state;
    status >> number >> name >> state;
    return !status || state == "Z";
  });
}

TEST(PlannerProcess, ThatHangsIsEndedWithAllThatItStarted) {
  const auto file =
      std::filesystem::path(::testing::TempDir()) / ("planner_hangs_" + std::to_string(::getpid()));
  EXPECT_EQ(planned_by("sleep 1000 & echo $! > " + file.string() + "; echo \"(a)\"; wait",
                       {.words = {}, .timeout = std::chrono::seconds(1), .memory = 0}),
            "deadline-exceeded: the planner found no plan within 1s");
  EXPECT_TRUE(is_gone(file));
  std::filesystem::remove(file);
}

TEST(PlannerProcess, LeavesNothingRunningWhenItEnds) {
  const auto file =
      std::filesystem::path(::testing::TempDir()) / ("planner_leaves_" + std::to_string(::getpid()));
  EXPECT_EQ(planned_by("sleep 1000 > /dev/null & echo $! > " + file.string() + "; echo \"(a)\""), "(a)\n");
  EXPECT_TRUE(is_gone(file));
  std::filesystem::remove(file);
}

TEST(PlannerProcess, IsEndedWhereItsUserStops) {
  const auto file =
      std::filesystem::path(::testing::TempDir()) / ("planner_stops_" + std::to_string(::getpid()));
  std::stop_source stop;
  std::jthread user([&] {
    EXPECT_TRUE(segue::testing::eventually([&] { return std::filesystem::exists(file); }));
    stop.request_stop();
  });
  EXPECT_EQ(planned_by("echo > " + file.string() + "; sleep 1000", {}, stop.get_token()),
            "cancelled: the planner was stopped");
  std::filesystem::remove(file);
}

TEST(PlannerProcess, HasItsLimits) {
  EXPECT_THAT(planned_by("exec yes"), HasSubstr("resource-exhausted: the planner wrote more than 64 MB"));
  EXPECT_EQ(
      planned_by("ulimit -v", {.words = {}, .timeout = std::chrono::seconds(60), .memory = 512'000'000}),
      "500000\n");
}

}  // namespace
}  // namespace segue::planner
