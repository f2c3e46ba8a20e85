// SPDX-License-Identifier: Apache-2.0
#include "chain_times.hpp"

#include <segue/type/yaml.hpp>

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace segue::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using type::Value;

Value yaml(const std::string& text) {
  auto value = type::parse_yaml(text);
  EXPECT_TRUE(value) << text;
  return value.value_or(Value());
}

/// A laser whose scans reach the drive on two ways.
const char* const kStatus = R"(
tasks:
  - {id: laser, component: x::Laser, host: localhost, process: sensors}
  - {id: guard, component: x::Guard, host: localhost, process: ""}
  - {id: planner, component: x::Planner, host: localhost, process: ""}
  - {id: drive, component: x::Drive, host: localhost, process: ""}
connections:
  - {from: laser.scan, to: guard.scan, measured: 5, latency_us: 10, latency_p99_us: 20, latency_worst_us: 40}
  - {from: laser.scan, to: planner.scan, measured: 5, latency_us: 30, latency_p99_us: 50, latency_worst_us: 60}
  - {from: planner.command, to: guard.command, measured: 0, latency_us: 0}
  - {from: guard.command, to: drive.command, measured: 5, latency_us: 1, latency_p99_us: 2, latency_worst_us: 4}
)";

Value task_json(const std::string& id) {
  if (id == "planner") return yaml("{timing: {cycles: 0}}");
  return yaml("{timing: {cycles: 9, mean_us: 100, worst_us: 400}, histograms: {updates: {p99_us: 200}}}");
}

std::vector<std::string> chains(const ChainNetwork& network, const std::string& from, const std::string& to) {
  const auto found = network.chains(*network.find(from), *network.find(to));
  if (!found) return {found.error().message};
  std::vector<std::string> texts;
  for (const auto& chain : *found) {
    std::string text;
    for (const auto& connection : chain)
      text += (text.empty() ? "" : ", ") + to_string(connection);
    texts.push_back(text);
  }
  return texts;
}

TEST(Chains, AreAllWaysTheShortestFirst) {
  const ChainNetwork network(yaml(kStatus));
  EXPECT_THAT(chains(network, "laser", "drive"),
              ElementsAre("laser.scan -> guard.scan, guard.command -> drive.command",
                          "laser.scan -> planner.scan, planner.command -> guard.command, guard.command -> "
                          "drive.command"));
  EXPECT_THAT(chains(network, "laser", "guard.command"),
              ElementsAre("laser.scan -> planner.scan, planner.command -> guard.command"));
  EXPECT_THAT(chains(network, "drive", "laser"),
              ElementsAre(HasSubstr("no connections lead from 'drive' to 'laser'")));
  const auto unknown = network.find("lasre.scan");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("no task 'lasre', did you mean 'laser'?"));
}

TEST(Chains, FromATaskToItselfAreItsLoops) {
  ChainNetwork network(yaml(kStatus));
  network.apply(yaml("actions: [{kind: connect, from: drive.pose, to: laser.pose}]"));
  EXPECT_THAT(chains(network, "guard", "guard").front(),
              "guard.command -> drive.command, drive.pose -> laser.pose, laser.scan -> guard.scan");
}

TEST(ChainTimes, AddUpConnectionsAndUpdates) {
  const ChainNetwork network(yaml(kStatus));
  MeasuredTimes measured(yaml(kStatus), task_json);
  const auto all = *network.chains(*network.find("laser"), *network.find("drive"));
  const ChainTimes times = measured.observed(all.front());
  ASSERT_EQ(times.steps.size(), 4U);
  ASSERT_TRUE(times.total());
  EXPECT_NEAR(times.total()->mean, 211e-6, 1e-9);
  EXPECT_NEAR(times.total()->p99, 422e-6, 1e-9);
  EXPECT_NEAR(times.total()->worst, 844e-6, 1e-9);
  EXPECT_TRUE(times.unmeasured().empty());
}

TEST(ChainTimes, SayWhatWasNeverMeasured) {
  const ChainNetwork network(yaml(kStatus));
  MeasuredTimes measured(yaml(kStatus), task_json);
  const auto all = *network.chains(*network.find("laser"), *network.find("guard.command"));
  EXPECT_THAT(measured.observed(all.front()).unmeasured(),
              ElementsAre("planner", "planner.command -> guard.command"));
  const auto none = *network.chains(*network.find("planner"), *network.find("guard"));
  MeasuredTimes nothing(yaml(kStatus), [](const std::string&) { return Value(); });
  EXPECT_FALSE(nothing.observed(none.front()).total());
}

TEST(ChainTimes, OfAControllerThatDoesNotRunAreThoseOfWhatIsLikeIt) {
  ChainNetwork network(yaml(kStatus));
  network.apply(yaml(R"(
actions:
  - {kind: disconnect, from: laser.scan, to: guard.scan}
  - {kind: apply_config, task: watch, process: sensors, host: localhost, definition: {component: x::Guard}}
  - {kind: apply_config, task: new, host: localhost, process: "", definition: {component: x::New}}
  - {kind: connect, from: laser.scan, to: watch.scan}
  - {kind: connect, from: watch.command, to: new.command}
removes: [guard]
)"));
  EXPECT_EQ(network.task("guard"), nullptr);
  MeasuredTimes measured(yaml(kStatus), task_json);
  const auto all = *network.chains(*network.find("laser"), *network.find("new"));
  const auto steps = measured.expected(all.front(), network).steps;
  ASSERT_EQ(steps.size(), 4U);
  EXPECT_EQ(steps[0].like, "connections to x::Guard.scan");
  EXPECT_NEAR(steps[0].times->mean, 10e-6, 1e-9);
  EXPECT_EQ(steps[1].like, "tasks of x::Guard");
  EXPECT_NEAR(steps[1].times->worst, 400e-6, 1e-9);
  EXPECT_EQ(steps[2].like, "connections between processes");
  EXPECT_NEAR(steps[2].times->mean, 20e-6, 1e-9) << "of both from the laser";
  EXPECT_FALSE(steps[3].times) << "nothing is known of x::New";
}

}  // namespace
}  // namespace segue::cli
