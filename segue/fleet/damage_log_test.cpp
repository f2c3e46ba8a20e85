// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/damage_log.hpp>

#include <gmock/gmock.h>

#include <chrono>
#include <string>
#include <vector>

namespace segue::fleet::detail {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

Suspect suspect(const std::string& name) {
  return {{model::HostName("left"), model::ProcessName(name)}, 7};
}

model::Connection connection_to(const std::string& reader) {
  model::Connection connection;
  connection.from = {model::TaskId("writer"), "out"};
  connection.to = {model::TaskId(reader), "in"};
  return connection;
}

class DamageLogTest : public ::testing::Test {
 protected:
  /// Sees that connection overwritten; the processes that are found to be at fault.
  std::vector<std::string> see(const std::string& reader, std::vector<Suspect> suspects, Duration at) {
    MergedView view;
    view.damaged.push_back({connection_to(reader), 0, std::move(suspects)});
    std::vector<std::string> names;
    const auto found = log_.note(view, TimePoint() + at);
    for (const auto& culprit : found.culprits)
      names.push_back(culprit.process.process.process.str());
    return names;
  }
  /// Sees that it carries samples again.
  void see_again(const std::string& reader, Duration at) {
    MergedView view;
    view.network.connections.push_back(connection_to(reader));
    log_.note(view, TimePoint() + at);
  }

  DamageLog log_;
};

TEST_F(DamageLogTest, WhoHasOverwrittenThreeConnectionsIsAtFault) {
  EXPECT_THAT(see("a", {suspect("p")}, seconds(1)), IsEmpty());
  EXPECT_THAT(see("b", {suspect("p")}, seconds(2)), IsEmpty());
  EXPECT_THAT(see("c", {suspect("p")}, seconds(3)), ElementsAre("p"));
}

TEST_F(DamageLogTest, AConnectionThatIsSeenOverwrittenForLongCountsOnce) {
  for (int second = 1; second <= 10; ++second)
    EXPECT_THAT(see("a", {suspect("p")}, seconds(second)), IsEmpty()) << second;
}

TEST_F(DamageLogTest, AConnectionThatIsOverwrittenAgainCountsAgain) {
  EXPECT_THAT(see("a", {suspect("p")}, seconds(1)), IsEmpty());
  see_again("a", seconds(2));
  EXPECT_THAT(see("a", {suspect("p")}, seconds(3)), IsEmpty());
  see_again("a", seconds(4));
  EXPECT_THAT(see("a", {suspect("p")}, seconds(5)), ElementsAre("p"));
}

TEST_F(DamageLogTest, WhatWasOverwrittenLongAgoDoesNotCount) {
  see("a", {suspect("p")}, seconds(0));
  see("b", {suspect("p")}, minutes(9));
  EXPECT_THAT(see("c", {suspect("p")}, minutes(10) + seconds(1)), IsEmpty());
}

TEST_F(DamageLogTest, WhatWasOverwrittenWithinTenMinutesCounts) {
  see("a", {suspect("p")}, seconds(0));
  see("b", {suspect("p")}, minutes(9));
  EXPECT_THAT(see("c", {suspect("p")}, minutes(10)), ElementsAre("p"));
}

TEST_F(DamageLogTest, NobodyIsAtFaultForWhatAnotherCanHaveDoneAsWell) {
  for (const char* reader : {"a", "b", "c", "d"})
    EXPECT_THAT(see(reader, {suspect("p"), suspect("q")}, seconds(1)), IsEmpty()) << reader;
}

TEST_F(DamageLogTest, WhoAloneCanHaveOverwrittenAllIsAtFault) {
  see("a", {suspect("p"), suspect("q")}, seconds(1));
  see("b", {suspect("p"), suspect("r")}, seconds(2));
  EXPECT_THAT(see("c", {suspect("p"), suspect("q")}, seconds(3)), ElementsAre("p"));
}

TEST_F(DamageLogTest, WhoWasFoundToBeAtFaultBeginsAnew) {
  for (const char* reader : {"a", "b", "c"})
    see(reader, {suspect("p")}, seconds(1));
  EXPECT_THAT(see("d", {suspect("p")}, seconds(2)), IsEmpty());
  EXPECT_THAT(see("e", {suspect("p")}, seconds(3)), IsEmpty());
  EXPECT_THAT(see("f", {suspect("p")}, seconds(4)), ElementsAre("p"));
}

TEST_F(DamageLogTest, AnotherIncarnationOfAProcessIsAnotherProcess) {
  const Suspect next{suspect("p").process, 8};
  see("a", {suspect("p")}, seconds(1));
  see("b", {suspect("p")}, seconds(2));
  EXPECT_THAT(see("c", {next}, seconds(3)), IsEmpty());
}

TEST_F(DamageLogTest, AConnectionIsReportedUntilATransitionIsComplete) {
  see("a", {suspect("p")}, seconds(1));
  EXPECT_EQ(log_.reports().size(), 1U);
  log_.clear();
  EXPECT_THAT(log_.reports(), IsEmpty());
}

}  // namespace
}  // namespace segue::fleet::detail
