// SPDX-License-Identifier: Apache-2.0
#include "missions_test_support.hpp"

namespace segue::testing {
namespace {

class Converted : public Missions {
 protected:
  void SetUp() override {
    Missions::SetUp();
    write("m.yaml", kTwoHands);
    write("loop.yaml", kEndless);
    write("n.json", kLong);
  }
};

TEST_F(Converted, AMachineShowsItsNodesAndTheReasonsOfTheirOrder) {
  const auto text = segue({"mission", "convert", "m.yaml"});
  EXPECT_EQ(text.status, 0) << text.errors;
  EXPECT_THAT(
      text.output,
      HasSubstr("0 hands: opaque subtree, since left in it, concurrent with others, may touch anything"));
  EXPECT_THAT(text.output,
              HasSubstr("    after 0 hands: opaque clap: it declares no facts and no resources"));
  const auto value = json({"mission", "convert", "m.yaml"});
  ASSERT_EQ(value.find("nodes")->as_list().size(), 2U);
  const auto& clap = value.find("nodes")->as_list()[1];
  EXPECT_EQ(clap.find("role")->as_string(), "irreversible");
  EXPECT_EQ(clap.find("after")->as_list()[0].find("because")->as_list()[0].find("kind")->as_string(),
            "opaque");
  EXPECT_TRUE(value.find("complete")->as_bool());
}

TEST_F(Converted, ATaskNetworkIsShownAsWell) {
  const auto text = segue({"mission", "convert", "n.json", "--strict"});
  EXPECT_EQ(text.status, 0) << text.errors;
  EXPECT_THAT(text.output, HasSubstr("    after 0 short: world p(): made true there, relied on here\n"));
  EXPECT_THAT(text.output, HasSubstr("strict: starts when nothing before it can fail any more"));
  EXPECT_EQ(segue({"mission", "convert", "n.json", "--order", "goal"}).status, 0);
}

TEST_F(Converted, WhatMayHappenAlthoughSomethingEarlierFailsIsListed) {
  const std::string actions =
      "mission: m\nactions:\n  drive: {effects: [\"+there()\"], run: {simulated: {}}}\n"
      "  unfold: {effects: [\"+unfolded()\"], STRICT run: {simulated: {}}}\n"
      "start: there\nstates:\n  there: {action: drive, on: {success: arm}}\n"
      "  arm: {action: unfold, on: {success: return success}}\n";
  const auto with = [&](const std::string& strict) {
    std::string text = actions;
    return text.replace(text.find("STRICT"), 6, strict);
  };
  write("open.yaml", with(""));
  write("strict.yaml", with("strict: true,"));
  const std::string listed = "    arm, although there fails\n";
  EXPECT_THAT(segue({"check", "open.yaml"}).output, HasSubstr(listed));
  EXPECT_THAT(segue({"mission", "check", "open.yaml"}).output, HasSubstr(listed));
  EXPECT_THAT(segue({"mission", "convert", "open.yaml"}).output, HasSubstr(listed));
  EXPECT_THAT(segue({"check", "strict.yaml"}).output, ::testing::StartsWith("1 file: no problems"));
  EXPECT_THAT(segue({"mission", "convert", "open.yaml", "--strict"}).output, Not(HasSubstr("although")));
  for (const std::string verb : {"check", "convert"}) {
    const auto ahead = json({"mission", verb, "open.yaml"}).find("ahead")->as_list();
    ASSERT_EQ(ahead.size(), 1U);
    EXPECT_EQ(ahead[0].find("happens")->as_string(), "arm");
    EXPECT_EQ(ahead[0].find("although_fails")->as_list()[0].as_string(), "there");
    EXPECT_TRUE(json({"mission", verb, "strict.yaml"}).find("ahead")->as_list().empty());
  }
}

TEST_F(Converted, PicturesGoToStandardOutputOrAFile) {
  const auto drawn = segue({"mission", "convert", "m.yaml", "--svg"});
  EXPECT_EQ(drawn.status, 0) << drawn.errors;
  EXPECT_THAT(drawn.output, ::testing::StartsWith("<svg"));
  EXPECT_THAT(drawn.output, ::testing::EndsWith("</svg>\n"));
  const auto quiet = segue({"mission", "convert", "m.yaml", "--dot", "-o", "m.dot"});
  EXPECT_EQ(quiet.status, 0) << quiet.errors;
  EXPECT_EQ(quiet.output, "");
  EXPECT_THAT(read("m.dot"), ::testing::StartsWith("digraph"));
  EXPECT_EQ(segue({"mission", "convert", "m.yaml", "--dot", "--svg"}).status, 2);
}

TEST_F(Converted, GoesToTheHorizonOrAsFarAsKnown) {
  const auto first = json({"mission", "convert", "loop.yaml", "--horizon", "7"});
  EXPECT_EQ(first.find("nodes")->as_list().size(), 7U);
  EXPECT_FALSE(first.find("complete")->as_bool());
  EXPECT_EQ(first.find("waits_for")->as_string(), "");
  const auto assumed = segue({"mission", "convert", "loop.yaml", "--horizon", "30", "--assume-expected"});
  EXPECT_EQ(assumed.status, 0) << assumed.errors;
  EXPECT_THAT(assumed.output, HasSubstr("as far as the horizon reaches"));
  EXPECT_EQ(segue({"mission", "convert", "loop.yaml", "--horizon", "0"}).status, 2);
  EXPECT_EQ(segue({"mission", "convert", "loop.yaml", "--horizon", "-1"}).status, 2);
}

TEST_F(Converted, ProblemsAreReportedWithTheirLocation) {
  write("broken.yaml", "mission: x\nstart: nowhere\nstates: {}\n");
  write("broken.json", R"({"nodes": [{"name": 3}]})");
  for (const std::string file : {"broken.yaml", "broken.json", "missing.yaml"}) {
    const auto run = segue({"mission", "convert", file});
    EXPECT_EQ(run.status, 1) << file;
    EXPECT_EQ(run.output, "") << file;
    EXPECT_THAT(run.errors, HasSubstr(file));
  }
  const auto input = segue({"mission", "convert", "m.yaml", "--input", "x=1"});
  EXPECT_EQ(input.status, 1);
  EXPECT_THAT(input.errors, HasSubstr("no input 'x'"));
  EXPECT_EQ(segue({"mission", "convert", "m.yaml", "--fact", "(("}).status, 1);
  EXPECT_EQ(segue({"mission", "convert", "n.json", "--fact", "p()"}).status, 1);
}

TEST_F(Converted, AFailedWriteLeavesNothing) {
  for (const std::string file : {"nowhere/x", ".", "m.yaml/x"}) {
    const auto run = segue({"mission", "convert", "m.yaml", "--svg", "-o", file});
    EXPECT_EQ(run.status, 1) << file;
    EXPECT_THAT(run.errors, HasSubstr("cannot write '" + file + "'"));
  }
  const FullDisk full(100);
  const auto run = segue({"mission", "convert", "m.yaml", "--svg", "-o", "out"});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.errors, HasSubstr("cannot write 'out': File too large"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(Converted, HostileNamesDoNoHarm) {
  write("h.json", R"j({"nodes": [{"name": "a\"</text>\nb\u001b[2J", "pia": true, "effects": ["+p()"]},
    {"name": "b", "pia": true, "preconditions": ["p()"], "effects": []}]})j");
  const auto text = segue({"mission", "convert", "h.json"});
  EXPECT_EQ(text.status, 0) << text.errors;
  EXPECT_THAT(text.output, HasSubstr("0 a\"</text> b\\x1b[2J: irreversible\n"));
  EXPECT_THAT(segue({"mission", "convert", "h.json", "--svg"}).output, HasSubstr("a&quot;&lt;/text&gt;"));
  EXPECT_THAT(segue({"mission", "convert", "h.json", "--dot"}).output, HasSubstr(R"("a\"</text>\nb [2J")"));
  const auto value = json({"mission", "convert", "h.json"});
  EXPECT_EQ(value.find("nodes")->as_list()[0].find("name")->as_string(), "a\"</text>\nb\x1b[2J");
}

}  // namespace
}  // namespace segue::testing
