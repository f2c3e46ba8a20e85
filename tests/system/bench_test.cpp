// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string>
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
  /// Other processes with the folders of this test, those of temporary hosts too.
  [[nodiscard]] std::vector<std::string> processes_left() const {
    std::vector<std::string> left;
    for (const auto& entry : fs::directory_iterator("/proc")) {
      const std::string pid = entry.path().filename();
      if (pid.find_first_not_of("0123456789") != std::string::npos || pid == std::to_string(::getpid()))
        continue;
      if (text_of(entry.path() / "environ").find(folder_.string()) != std::string::npos)
        left.push_back(text_of(entry.path() / "cmdline"));
    }
    return left;
  }

  /// A host of this computer that is not the bench's own.
  [[nodiscard]] std::unique_ptr<Process> start_host() const {
    fs::create_directories(folder_ / "arm");
    auto daemon = std::make_unique<Process>(
        std::vector<std::string>{"/usr/bin/env", "XDG_RUNTIME_DIR=" + (folder_ / "arm").string(),
                                 segue::paths::kProgram, "host", "--name", "arm", "--state",
                                 (folder_ / "arm" / "state").string()},
        folder_);
    EXPECT_TRUE(daemon->wait_for("host arm is running"));
    return daemon;
  }

  [[nodiscard]] bool a_deployment_runs() const {
    std::error_code none_yet;
    fs::directory_iterator entries(folder_ / "runtime" / "segue" / "segue-bench", none_yet);
    return !none_yet && std::any_of(begin(entries), end(entries),
                                    [](const auto& entry) { return entry.path().extension() == ".sock"; });
  }
};

/// The rows of the only experiment of a run in JSON.
const type::Value::List& rows_of(const type::Value& report) {
  const type::Value* experiments = report.find("experiments");
  if (experiments == nullptr) throw std::runtime_error("this is not a report: " + type::to_json(report));
  return experiments->as_list().at(0).find("rows")->as_list();
}

std::string text(const type::Value& row, const char* key) {
  return row.find(key) == nullptr ? "" : row.find(key)->as_string();
}

/// Every row has as many measurements as asked for, all positive and in order.
void expect_plausible(const type::Value& report, std::size_t count) {
  for (const type::Value& row : rows_of(report)) {
    SCOPED_TRACE(text(row, "what") + ", " + text(row, "transport"));
    EXPECT_EQ(row.find("seconds")->as_list().size(), count);
    EXPECT_GT(row.find("least_s")->as_double(), 0);
    EXPECT_LE(row.find("least_s")->as_double(), row.find("median_s")->as_double());
    EXPECT_LE(row.find("median_s")->as_double(), row.find("p99_s")->as_double());
    EXPECT_LE(row.find("p99_s")->as_double(), row.find("most_s")->as_double());
    if (row.find("floor_s") != nullptr) {
      EXPECT_GT(row.find("floor_s")->as_double(), 0);
    }
  }
}

std::set<std::string> values_of(const type::Value& report, const char* key) {
  std::set<std::string> values;
  for (const type::Value& row : rows_of(report))
    values.insert(text(row, key));
  return values;
}

TEST_F(Bench, ItListsTheExperimentsOfThePaper) {
  const auto listed = segue({"bench"});
  EXPECT_EQ(listed.status, 0) << listed.errors;
  for (const std::string name : {"E1.1", "E1.2", "E2.1", "E2.2", "E2.3"})
    EXPECT_NE(listed.output.find(name), std::string::npos) << listed.output;
  const auto value = json({"bench"});
  ASSERT_EQ(value.find("experiments")->as_list().size(), 5U);
  EXPECT_NE(text(value.find("experiments")->as_list()[0], "published"), "");
}

TEST_F(Bench, LatenciesAreMeasuredByLengthOnEachTransport) {
  const auto report = json({"bench", "E1.2", "--relays", "1,3", "--repetitions", "12"});
  EXPECT_EQ(rows_of(report).size(), 6U);
  EXPECT_EQ(values_of(report, "transport"), (std::set<std::string>{"local", "shm", "remote"}));
  EXPECT_EQ(values_of(report, "published"),
            (std::set<std::string>{"0.02 ms a relay", "0.14 ms a relay", "0.22 ms a relay"}));
  expect_plausible(report, 12);
  const bool two_processors = std::thread::hardware_concurrency() > 1;
  for (const type::Value& row : rows_of(report)) {
    EXPECT_NE(row.find("floor_s"), nullptr);
    EXPECT_EQ(row.find("floor_across_s") != nullptr, two_processors);
    EXPECT_EQ(row.find("bytes")->as_uint(), 100U);
  }
  EXPECT_EQ(processes_left(), std::vector<std::string>{});
}

TEST_F(Bench, LatenciesAreMeasuredBySize) {
  const auto report = json({"bench", "E1.1", "--bytes", "100,200000", "--repetitions", "5"});
  expect_plausible(report, 5);
  std::multiset<std::uint64_t> sizes;
  for (const type::Value& row : rows_of(report))
    sizes.insert(row.find("bytes")->as_uint());
  EXPECT_EQ(sizes, (std::multiset<std::uint64_t>{100, 100, 100, 200000, 200000, 200000}));
}

TEST_F(Bench, ChainsAreBroughtUpAndTakenDown) {
  const auto report = json({"bench", "E2.1", "--relays", "2", "--repetitions", "2"});
  expect_plausible(report, 2);
  EXPECT_EQ(rows_of(report).size(), 6U);
  EXPECT_EQ(values_of(report, "what"), (std::set<std::string>{"bring-up", "tear-down"}));
  EXPECT_EQ(processes_left(), std::vector<std::string>{});
}

TEST_F(Bench, EveryKindOfActionIsMeasured) {
  const auto report = json({"bench", "E2.2", "--transport", "shm", "--repetitions", "2"});
  EXPECT_EQ(values_of(report, "what"),
            (std::set<std::string>{"recover", "stop", "disconnect", "cleanup", "undeploy", "deploy",
                                   "apply_config", "configure", "connect", "start", "call_operation"}));
  for (const type::Value& row : rows_of(report)) {
    const std::string what = text(row, "what");
    const bool once = what == "recover" || what == "call_operation";
    const bool on_connections = what == "connect" || what == "disconnect";
    EXPECT_EQ(row.find("seconds")->as_list().size(), once ? 2U : on_connections ? 4U : 6U) << what;
  }
}

TEST_F(Bench, ActionsOnAnotherHostAreMeasuredBesideARoundTrip) {
  const auto report = json({"bench", "E2.2", "--transport", "remote", "--repetitions", "2"});
  EXPECT_EQ(
      values_of(report, "what"),
      (std::set<std::string>{"recover", "stop", "disconnect", "cleanup", "undeploy", "deploy", "apply_config",
                             "configure", "connect", "start", "call_operation", "round trip"}));
  EXPECT_EQ(values_of(report, "published"), (std::set<std::string>{"", "0.5 + 1.3 ms", "tens of ms"}));
  EXPECT_EQ(processes_left(), std::vector<std::string>{});
}

TEST_F(Bench, AHostThatRunsIsUsedAndLeftAsItWas) {
  const auto daemon = start_host();
  const auto report = json({"bench", "E2.1", "--transport", "remote", "--host",
                            "arm=unix:arm/segue/@host.sock", "--relays", "2", "--repetitions", "2"});
  expect_plausible(report, 2);
  EXPECT_EQ(rows_of(report).size(), 2U);
  for (const type::Value& row : rows_of(report))
    EXPECT_EQ(row.find("floor_s"), nullptr) << "of another computer";
  for (const std::string& process : processes_left())
    EXPECT_EQ(process.find("segue-bench"), std::string::npos) << process;
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait().status, 0);
}

TEST_F(Bench, WhatFailsIsNamedAndTheRestGoesOn) {
  const auto finished = segue({"bench", "E2.1", "E2.3", "--host", "arm=unix:no.sock", "--relays", "2",
                               "--repetitions", "1", "--format", "json"});
  EXPECT_EQ(finished.status, 1);
  const auto report = type::parse_json(finished.output);
  ASSERT_TRUE(report) << finished.output << finished.errors;
  for (const type::Value& experiment : report->find("experiments")->as_list()) {
    std::set<std::string> measured;
    for (const type::Value& row : experiment.find("rows")->as_list())
      measured.insert(text(row, "transport"));
    EXPECT_EQ(measured, (std::set<std::string>{"local", "shm"}));
    ASSERT_EQ(experiment.find("failures")->as_list().size(), 1U);
    const std::string& failure = experiment.find("failures")->as_list()[0].as_string();
    EXPECT_NE(failure.find("remote, 2 relays, 100B: "), std::string::npos) << failure;
    EXPECT_NE(failure.find("arm"), std::string::npos) << failure;
  }
  const auto in_text = segue({"bench", "E2.1", "--transport", "remote", "--host", "arm=unix:no.sock",
                              "--relays", "2", "--repetitions", "1"});
  EXPECT_EQ(in_text.status, 1);
  EXPECT_NE(in_text.errors.find("E2.1 was not measured: remote"), std::string::npos) << in_text.errors;
}

TEST_F(Bench, HalfIsExchangedOnAnotherHost) {
  const auto report = json({"bench", "E2.3", "--transport", "remote", "--relays", "4", "--repetitions", "2"});
  expect_plausible(report, 2);
  EXPECT_EQ(rows_of(report).size(), 9U);
}

TEST_F(Bench, HalfIsExchangedAndComparedWithARestart) {
  const auto report = json({"bench", "E2.3", "--transport", "local", "--relays", "4", "--repetitions", "3"});
  expect_plausible(report, 3);
  EXPECT_EQ(
      values_of(report, "what"),
      (std::set<std::string>{
          "exchange of the second half", "pause of the second half", "exchange of the second half, prepared",
          "pause of the second half, prepared", "exchange of every second", "pause of every second",
          "exchange of every second, prepared", "pause of every second, prepared", "restart"}));
}

TEST_F(Bench, ATableShowsThePublishedFiguresAndWhatIsNotMeasured) {
  const auto finished =
      segue({"bench", "E2.1", "--transport", "local", "--relays", "25", "--repetitions", "1"});
  ASSERT_EQ(finished.status, 0) << finished.errors;
  for (const std::string part : {"bring-up", "some ms", "floor", "Not measured: CORBA"})
    EXPECT_NE(finished.output.find(part), std::string::npos) << finished.output;
}

TEST_F(Bench, MeasurementsAreWrittenAsFiles) {
  const auto finished = segue({"bench", "E2.1", "E2.2", "--transport", "local", "--relays", "1,2",
                               "--repetitions", "2", "--out", "results"});
  ASSERT_EQ(finished.status, 0) << finished.errors;
  const std::string csv = text_of(folder_ / "results" / "E2.1.csv");
  EXPECT_EQ(csv.rfind("what,transport,relays,bytes,repetition,milliseconds\n", 0), 0U) << csv;
  EXPECT_EQ(lines_of(folder_ / "results" / "E2.1.csv"), 1 + 2 * 2 * 2);
  EXPECT_NE(csv.find("\ntear-down,local,2,100,2,"), std::string::npos) << csv;
  EXPECT_EQ(text_of(folder_ / "results" / "E2.1.svg").rfind("<svg ", 0), 0U);
  EXPECT_GT(lines_of(folder_ / "results" / "E2.2.csv"), 10);
}

TEST_F(Bench, AnInterruptEndsItCleanlyAndKeepsTheResults) {
  Process bench(command({"bench", "E2.1", "--transport", "shm", "--relays", "1", "--repetitions", "100000",
                         "--out", "results"}),
                folder_);
  ASSERT_TRUE(eventually([&] { return a_deployment_runs(); }));
  bench.signal(SIGINT);
  const auto finished = bench.wait();
  EXPECT_EQ(finished.status, 1) << finished.output << finished.errors;
  EXPECT_NE(finished.errors.find("interrupted"), std::string::npos) << finished.errors;
  EXPECT_GT(lines_of(folder_ / "results" / "E2.1.csv"), 1);
  EXPECT_EQ(processes_left(), std::vector<std::string>{});
}

TEST_F(Bench, AnInterruptEndsTheOtherHostToo) {
  Process bench(
      command({"bench", "E1.1", "--transport", "remote", "--relays", "1", "--repetitions", "1000000"}),
      folder_);
  ASSERT_TRUE(eventually([&] { return a_deployment_runs(); }));
  EXPECT_NE(processes_left(), std::vector<std::string>{});
  bench.signal(SIGINT);
  EXPECT_EQ(bench.wait().status, 1);
  EXPECT_EQ(processes_left(), std::vector<std::string>{});
}

TEST_F(Bench, WrongArgumentsAreExplained) {
  const auto unknown = segue({"bench", "E3"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.errors.find("E2.3"), std::string::npos) << unknown.errors;
  const auto lengths = segue({"bench", "E1.1", "--relays", "5,x"});
  EXPECT_EQ(lengths.status, 2);
  EXPECT_NE(lengths.errors.find("separated by commas, got '5,x'"), std::string::npos) << lengths.errors;
  EXPECT_EQ(segue({"bench", "E1.1", "--transport", "dds"}).status, 2);
  const auto host = segue({"bench", "E1.1", "--host", "tcp://10.0.0.2:7447"});
  EXPECT_EQ(host.status, 2);
  EXPECT_NE(host.errors.find("expected the host's name and address, NAME=tcp://... or NAME=unix:..."),
            std::string::npos)
      << host.errors;
  EXPECT_EQ(segue({"bench", "E1.1", "--credentials", "folder"}).status, 2);
}

TEST_F(Bench, AFolderThatCannotBeCreatedIsExplained) {
  write("taken", "a file");
  const auto finished = segue({"bench", "E2.1", "--out", "taken/results"});
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.errors.find("cannot create the folder 'taken/results'"), std::string::npos)
      << finished.errors;
}

}  // namespace
}  // namespace segue::testing
