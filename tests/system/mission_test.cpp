// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

/// Two branches side by side, of 2 s and of 1 s + 4 s, then 3 s.
constexpr const char* kTwoHands = R"(mission: two_hands
actions:
  left: {run: {simulated: {duration: 2s}}}
  right: {run: {simulated: {duration: 1s}}}
  far: {resources: [{block: arm}], run: {simulated: {duration: 4s}}}
  both: {outcomes: [fine], run: {decide: [{outcome: fine}]}}
  clap: {run: {simulated: {duration: 3s}}}
start: hands
states:
  hands:
    kind: barrier
    outcomes: [fine]
    on: {fine: clap}
    states:
      left: {on: {success: return fine}}
      right:
        outcomes: [fine]
        on: {fine: return fine}
        start: right
        states:
          right: {on: {success: far}}
          far: {on: {success: return fine}}
      both: {kind: decider, on: {fine: return fine}}
  clap: {on: {success: return success}}
)";

class Missions : public SystemTest {
 protected:
  std::string read(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(Missions, AMachineTellsWhatItWasAsLongForAndWhatWouldFollowOneAfterTheOther) {
  write("m.yaml", kTwoHands);
  const auto run = json({"mission", "run", "m.yaml", "--clock", "virtual"});
  EXPECT_EQ(run.find("makespan_s")->as_double(), 8);
  EXPECT_EQ(run.find("sequential_s")->as_double(), 10);
  EXPECT_EQ(run.find("critical_path_s")->as_double(), 8);
  const auto& clap = run.find("nodes")->as_list().back();
  ASSERT_EQ(clap.find("name")->as_string(), "clap");
  const auto& waits = clap.find("waited_for")->as_list();
  ASSERT_EQ(waits.size(), 1U);
  EXPECT_EQ(waits[0].find("node")->as_string(), "hands/both");
  EXPECT_EQ(waits[0].find("subject")->as_string(), "fine");
}

TEST_F(Missions, AMachineIsDrawnAsATaskNetworkIs) {
  write("m.yaml", kTwoHands);
  const auto run =
      segue({"mission", "run", "m.yaml", "--clock", "virtual", "--svg", "m.svg", "--trace", "t"});
  ASSERT_EQ(run.status, 0) << run.errors;
  EXPECT_THAT(read("m.svg"), HasSubstr(">hands/right/far</text>"));
  EXPECT_THAT(read("m.svg"), HasSubstr("waits for condition success of hands/right/right, until 1.00 s"));
  EXPECT_TRUE(type::parse_json(read("t")));
}

TEST_F(Missions, ADrawingAloneGoesToStandardOutput) {
  write("m.yaml", kTwoHands);
  write("n.json", R"({"nodes": [{"name": "dig", "duration_s": 1}]})");
  for (const std::string file : {"m.yaml", "n.json"}) {
    const auto drawn = segue({"mission", "gantt", file, "--html", "page.html"});
    EXPECT_EQ(drawn.status, 0) << drawn.errors;
    EXPECT_THAT(drawn.output, ::testing::StartsWith("<svg"));
    EXPECT_THAT(drawn.output, ::testing::EndsWith("</svg>\n"));
    EXPECT_THAT(read("page.html"), ::testing::StartsWith("<!DOCTYPE html>"));
  }
}

TEST_F(Missions, OneFileDoesNotHoldTwoThings) {
  write("n.json", R"({"nodes": [{"name": "dig", "duration_s": 1}]})");
  const auto run = segue({"mission", "run", "n.json", "--clock", "virtual", "--svg", "x", "--html", "x"});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.errors, HasSubstr("'x' cannot hold two things"));
}

TEST_F(Missions, WhatCannotBeWrittenIsToldBeforeTheRun) {
  write("m.yaml", kTwoHands);
  for (const std::string option : {"--svg", "--html", "--trace"}) {
    for (const std::string file : {"nowhere/x", ".", "m.yaml/x"}) {
      const auto run = segue({"mission", "run", "m.yaml", "--clock", "virtual", option, file});
      EXPECT_EQ(run.status, 1) << option << ' ' << file;
      EXPECT_EQ(run.output, "") << "it ran";
      EXPECT_THAT(run.errors, HasSubstr("cannot write '" + file + "'"));
    }
  }
}

}  // namespace
}  // namespace segue::testing
