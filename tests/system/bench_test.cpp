// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <thread>

#include "system_test.hpp"

namespace segue::testing {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::ptrdiff_t lines_of(const fs::path& file) {
  const std::string text = text_of(file);
  return std::count(text.begin(), text.end(), '\n');
}

class Bench : public SystemTest {
 protected:
  /// Other processes with the runtime folder of this test.
  [[nodiscard]] std::vector<std::string> processes_left() const {
    std::vector<std::string> left;
    for (const auto& entry : fs::directory_iterator("/proc")) {
      const std::string pid = entry.path().filename();
      if (pid.find_first_not_of("0123456789") != std::string::npos || pid == std::to_string(::getpid()))
        continue;
      if (text_of(entry.path() / "environ").find((folder_ / "runtime").string()) != std::string::npos)
        left.push_back(text_of(entry.path() / "cmdline"));
    }
    return left;
  }

  [[nodiscard]] bool a_deployment_runs() const {
    std::error_code none_yet;
    fs::directory_iterator entries(folder_ / "runtime" / "segue" / "segue-bench", none_yet);
    return !none_yet && std::any_of(begin(entries), end(entries),
                                    [](const auto& entry) { return entry.path().extension() == ".sock"; });
  }
};

TEST_F(Bench, ItWritesEverySeriesAndLeavesNoProcess) {
  const auto finished = segue({"bench", "--quick", "--out", "results"});
  ASSERT_EQ(finished.status, 0) << finished.output << finished.errors;
  for (const std::string series : {"E1.1", "E1.2", "E2.1", "E2.2", "E2.3_best", "E2.3_worst", "E2.3_gap"}) {
    const fs::path file = folder_ / "results" / series;
    const std::string csv = text_of(file.string() + ".csv");
    EXPECT_EQ(csv.rfind("placement,relays,repetition,milliseconds\n", 0), 0U) << series;
    EXPECT_NE(csv.find("\none process,4,2,"), std::string::npos) << csv;
    EXPECT_NE(csv.find("\na process for each task,2,2,"), std::string::npos) << csv;
    const std::string svg = text_of(file.string() + ".svg");
    EXPECT_EQ(svg.rfind("<svg ", 0), 0U) << series;
    EXPECT_NE(svg.find("</svg>\n"), std::string::npos) << series;
  }
  EXPECT_EQ(lines_of(folder_ / "results" / "E1.1.csv"), 1 + (3 + 2) * 2);
  EXPECT_NE(finished.output.find("E2.3 worst"), std::string::npos) << finished.output;
  EXPECT_EQ(processes_left(), std::vector<std::string>{});
}

TEST_F(Bench, AnInterruptEndsItCleanlyAndKeepsTheResults) {
  Process bench(command({"bench", "--quick", "--repeat", "1000", "--out", "results"}), folder_);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!a_deployment_runs()) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  bench.signal(SIGINT);
  const auto finished = bench.wait();
  EXPECT_EQ(finished.status, 1) << finished.output << finished.errors;
  EXPECT_NE(finished.errors.find("interrupted"), std::string::npos) << finished.errors;
  EXPECT_GT(lines_of(folder_ / "results" / "E1.1.csv"), 1);
  EXPECT_EQ(processes_left(), std::vector<std::string>{});
}

TEST_F(Bench, AFolderThatCannotBeCreatedIsExplained) {
  write("taken", "a file");
  const auto finished = segue({"bench", "--quick", "--out", "taken/results"});
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.errors.find("cannot create the folder 'taken/results'"), std::string::npos)
      << finished.errors;
}

}  // namespace
}  // namespace segue::testing
