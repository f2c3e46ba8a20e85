// SPDX-License-Identifier: Apache-2.0
// `segue bench transitions` on robots of stand-ins.
#include <segue/type/yaml.hpp>

#include <gmock/gmock.h>

#include <iterator>
#include <map>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kArtemis = std::string(segue::paths::kSourceFolder) + "/examples/04_artemis/";

class BenchTransitions : public SystemTest {
 protected:
  /// Two controllers of a component that is not installed.
  void SetUp() override {
    SystemTest::SetUp();
    write("pair/robot.yaml", "robot: pair\ncontrollers: [controllers/*.yaml]\n");
    write("pair/controllers/one.yaml",
          "network: one\ntasks: {a: {component: \"x::A\"}, b: {component: \"x::A\"}}\n");
    write("pair/controllers/two.yaml",
          "network: two\ntasks: {b: {component: \"x::A\"}, c: {component: \"x::A\"}}\n");
  }
};

TEST_F(BenchTransitions, AllTransitionsOfThePapersRoverHaveItsNumbersOfActions) {
  const auto report = json(
      {"bench", "transitions", kArtemis + "robot.yaml", "--stand-in", "--in-process", "--repetitions", "2"});
  const auto table = type::load_yaml(kArtemis + "table7.yaml");
  ASSERT_TRUE(table) << to_string(table.error());
  std::map<std::string, std::int64_t> published;
  for (const type::Value& one : table->find("transitions")->as_list())
    published[one.find("from")->as_string() + " " + one.find("to")->as_string()] =
        one.find("total")->as_int();
  const auto& transitions = report.find("transitions")->as_list();
  ASSERT_EQ(transitions.size(), 12U);
  for (const type::Value& one : transitions) {
    const std::string name = one.find("from")->as_string() + " " + one.find("to")->as_string();
    EXPECT_EQ(one.find("actions")->as_int(), published.at(name)) << name;
    EXPECT_GE(one.find("seconds")->as_list().size(), 2U) << name;
    EXPECT_EQ(one.find("slowest")->as_list().size(), 3U) << name;
    EXPECT_LE(one.find("commit_s")->as_double(), one.find("median_s")->as_double()) << name;
  }
}

TEST_F(BenchTransitions, TheMatrixStandsBesideThePublishedOneAndEachExecutionInAFile) {
  const auto finished = segue({"bench", "transitions", "pair/robot.yaml", "--stand-in", "--in-process",
                               "--repetitions", "3", "--published", "0.5,4.25", "--out", "results"});
  ASSERT_EQ(finished.status, 0) << finished.errors;
  EXPECT_THAT(finished.output, HasSubstr("(4.25 s)"));
  EXPECT_THAT(finished.output, HasSubstr("one -> two"));
  std::ifstream file(folder_ / "results/transitions.csv");
  const std::string csv{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(csv, HasSubstr("from,to,repetition,milliseconds,commit_milliseconds\n"));
  EXPECT_THAT(csv, HasSubstr("\ntwo,one,3,"));
}

TEST_F(BenchTransitions, AFailureEndsItAndTheRobotStops) {
  write("pair/stand_ins.yaml", "stand_ins: {c: {fail: [start]}}\n");
  const auto finished =
      segue({"bench", "transitions", "pair/robot.yaml", "--stand-ins", "pair/stand_ins.yaml"});
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.errors, HasSubstr("the switch to 'two' was not done"));
  EXPECT_TRUE(eventually([&] { return processes_of(folder_ / "runtime").empty(); })) << "a process is left";
}

TEST_F(BenchTransitions, WrongArgumentsAreExplained) {
  const std::vector<std::string> begin = {"bench", "transitions", "pair/robot.yaml", "--stand-in",
                                          "--in-process"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), begin.begin(), begin.end());
    return segue(more);
  };
  EXPECT_THAT(with({"--controller", "tow"}).errors, HasSubstr("did you mean 'two'?"));
  EXPECT_THAT(with({"--controller", "two"}).errors, HasSubstr("fewer than two controllers"));
  EXPECT_THAT(with({"--published", "1,2,3"}).errors, HasSubstr("2 transitions; 3 published figures"));
  EXPECT_EQ(with({"--published", "fast"}).status, 2);
  EXPECT_EQ(with({"--table", "6"}).status, 2);
  EXPECT_THAT(segue({"bench", "transitions"}).errors, HasSubstr("name the robot file"));
}

}  // namespace
}  // namespace segue::testing
