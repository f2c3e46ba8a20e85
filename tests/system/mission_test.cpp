// SPDX-License-Identifier: Apache-2.0
#include "missions_test_support.hpp"

namespace segue::testing {
namespace {

TEST_F(Missions, AMachineReportsItsCriticalPathAndSequentialTime) {
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

/// `short` may run beside `long`, `last` only after it.
constexpr const char* kTimed = R"j(mission: timed
actions:
  short: {effects: ["+seen()"], run: {simulated: {duration: 300ms}}}
  long: {effects: ["+ready()"], run: {simulated: {duration: 600ms}}}
  last: {preconditions: ["ready()"], run: {simulated: {duration: 10ms}}}
start: long
states:
  long: {on: {success: short}}
  short: {on: {success: last}}
  last: {on: {success: return success}}
)j";

TEST_F(Missions, ItsProgressIsRewrittenOnATerminal) {
  write("m.yaml", kTimed);
  const auto run = run_on_terminal(command({"mission", "run", "m.yaml", "--mode", "concurrent"}), folder_);
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("  running  long"));
  EXPECT_THAT(run.output, HasSubstr("  running  short"));
  EXPECT_THAT(run.output, HasSubstr("  waits    last"));
  EXPECT_THAT(run.output, HasSubstr("for long")) << "it makes the fact true that `last` needs";
  EXPECT_THAT(run.output, HasSubstr(" done, ")) << "`short` ends 300 ms before `long`";
  const auto table = run.output.rfind("\x1b[J");
  ASSERT_NE(table, std::string::npos) << "the block is rewritten";
  EXPECT_THAT(run.output.substr(table), HasSubstr("timed: success")) << "the block has gone from what stays";
  EXPECT_THAT(run.output.substr(table), Not(HasSubstr(" running, ")));
  const auto quiet = run_on_terminal(command({"mission", "run", "m.yaml", "--no-progress"}), folder_);
  EXPECT_THAT(quiet.output, Not(HasSubstr("\x1b[J")));
}

TEST_F(Missions, ItsProgressIsALineForEachEventElsewhere) {
  write("m.yaml", kTimed);
  const auto run = segue({"mission", "run", "m.yaml"});
  ASSERT_EQ(run.status, 0) << run.errors;
  for (const char* part : {" s  began long\n", " s  ended long: success\n", " s  began last\n"})
    EXPECT_THAT(run.errors, HasSubstr(part));
  EXPECT_THAT(run.errors, Not(HasSubstr("\x1b")));
  EXPECT_EQ(segue({"mission", "run", "m.yaml", "--no-progress"}).errors, "");
  EXPECT_EQ(segue({"mission", "run", "m.yaml", "--clock", "virtual"}).errors, "") << "no time passes";
  EXPECT_EQ(segue({"mission", "run", "m.yaml", "--format", "json"}).errors, "");
}

TEST_F(Missions, ItsEventsAreFollowed) {
  write("m.yaml", kTimed);
  write("n.json",
        R"({"name": "n", "nodes": [{"name": "a", "duration_s": 1}, {"name": "b", "duration_s": 2}]})");
  const auto text = segue({"mission", "run", "m.yaml", "--follow", "--clock", "virtual"});
  EXPECT_EQ(text.output.rfind("began long\nended long: success\nbegan short\n", 0), 0U) << text.output;
  EXPECT_EQ(text.errors, "");
  const auto timed = segue({"mission", "run", "m.yaml", "-f"});
  EXPECT_THAT(timed.output, HasSubstr(" s  began long\n"));
  for (const std::string file : {"m.yaml", "n.json"}) {
    for (const std::string mode : {"sequential", "concurrent"}) {
      const auto run =
          segue({"mission", "run", file, "-f", "--format", "json", "--clock", "virtual", "--mode", mode});
      ASSERT_EQ(run.status, 0) << run.errors;
      std::istringstream lines(run.output);
      std::vector<type::Value> values;
      for (std::string line; std::getline(lines, line);) {
        const auto value = type::parse_json(line);
        ASSERT_TRUE(value) << line;
        values.push_back(*value);
      }
      const std::size_t nodes = file == "m.yaml" ? 3 : 2;
      ASSERT_EQ(values.size(), 2 * nodes + 1) << run.output;
      EXPECT_EQ(values.front().find("kind")->as_string(), "began");
      EXPECT_EQ(values.front().find("time_s"), nullptr) << "the clock is virtual";
      EXPECT_EQ(values[2 * nodes - 1].find("outcome")->as_string(), "success");
      EXPECT_EQ(values.back().find("nodes")->as_list().size(), nodes) << "the run comes last";
    }
  }
}

TEST_F(Missions, ATaskNetworkShowsWhatWaits) {
  write("n.json", R"j({"name": "n", "nodes": [
    {"name": "dig", "duration_s": 0.3, "effects": ["+hole()"]},
    {"name": "plant", "duration_s": 0.1, "preconditions": ["hole()"]}]})j");
  const auto run = run_on_terminal(command({"mission", "run", "n.json"}), folder_);
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("  running  dig"));
  EXPECT_THAT(run.output, HasSubstr("  waits    plant  for dig"));
}

TEST_F(Missions, AWatchdogIsNoSequentialTime) {
  write("m.yaml", R"(mission: guarded
actions:
  work: {run: {simulated: {duration: 2s}}}
  poll: {run: {simulated: {duration: 500ms}}}
  watch: {run: {simulated: {duration: 60s}}}
start: both
states:
  both:
    kind: preemptive
    outcomes: [done]
    on: {done: return success}
    states:
      work: {on: {success: return done}}
      watch: {on: {success: return done}}
      polls:
        outcomes: [done]
        on: {done: return done}
        start: poll
        states:
          poll: {on: {success: poll}}
)");
  for (const std::string mode : {"sequential", "concurrent"}) {
    const auto run = json({"mission", "run", "m.yaml", "--clock", "virtual", "--mode", mode});
    EXPECT_EQ(run.find("makespan_s")->as_double(), 2) << mode;
    EXPECT_EQ(run.find("sequential_s")->as_double(), 2) << mode;
  }
}

TEST_F(Missions, AMissionBeginsWithTheUnitsThatAreGiven) {
  write("m.yaml", R"(mission: m
resources: {cup: {count: 3}}
actions: {pour: {resources: [{consume: cup}], run: {simulated: {duration: 1s}}}}
start: first
states:
  first: {action: pour, on: {success: second}}
  second: {action: pour, on: {success: return success}}
)");
  for (const std::string mode : {"sequential", "concurrent"}) {
    std::vector<std::string> run = {"mission", "run", "m.yaml", "--clock", "virtual", "--mode", mode};
    EXPECT_EQ(json(run).find("units")->find("cup")->as_uint(), 1) << mode;
    run.insert(run.end(), {"--resource", "cup=1", "--journal", "journal." + mode});
    const auto few = segue(run);
    EXPECT_EQ(few.status, 1) << mode;
    EXPECT_THAT(few.errors, HasSubstr("it needs 1 of the resource 'cup', of which there are 0")) << mode;
    run.push_back("--resume");
    EXPECT_THAT(segue(run).errors, HasSubstr("that run has ended")) << mode;
  }
}

TEST_F(Missions, ASeedVariesDurations) {
  write("m.yaml", R"(mission: m
actions:
  look: {effects: ["+seen"], run: {simulated: {duration: 4s}}}
  grasp: {effects: ["+held"], expect: {duration: 4s}, run: {callback: grasp}}
start: look
states:
  look: {on: {success: grasp}}
  grasp: {on: {success: return success}}
)");
  const auto durations = [this](const std::string& mode, const std::string& seed) {
    const auto run = json(
        {"mission", "run", "m.yaml", "--clock", "virtual", "--simulate", "--mode", mode, "--seed", seed});
    std::vector<double> found;
    for (const auto& node : run.find("nodes")->as_list())
      found.push_back(node.find("end_s")->as_double() - node.find("start_s")->as_double());
    return found;
  };
  const auto one = durations("sequential", "1");
  const auto two = durations("sequential", "2");
  EXPECT_NE(one, two);
  EXPECT_EQ(one.size(), 2);
  EXPECT_NE(one.at(0), one.at(1));
  for (const double duration : one)
    EXPECT_TRUE(duration >= 2 && duration <= 8) << duration;
  const auto concurrent = durations("concurrent", "1");
  for (std::size_t i = 0; i < one.size(); ++i)
    EXPECT_NEAR(concurrent.at(i), one[i], 1e-6) << "the same in either mode";
  EXPECT_EQ(durations("sequential", "0"), (std::vector<double>{4, 4}));
}

TEST_F(Missions, AMachineRunsConcurrently) {
  write("m.yaml", R"j(mission: m
actions:
  warm_up: {effects: ["+warm()"], run: {simulated: {duration: 4s}}}
  look: {pure: true, outputs: {pose: int}, run: {simulated: {duration: 3s, outputs: {pose: 7}}}}
  grasp: {inputs: {pose: int}, preconditions: ["warm()"], run: {simulated: {duration: 1s}}}
start: warm_up
outputs: {pose: int}
flows: [look.pose -> grasp.pose, look.pose -> outputs.pose]
states:
  warm_up: {on: {success: look}}
  look: {on: {success: grasp}}
  grasp: {on: {success: return success}}
)j");
  const auto run = json({"mission", "run", "m.yaml", "--clock", "virtual", "--mode", "concurrent"});
  EXPECT_EQ(run.find("makespan_s")->as_double(), 5);
  EXPECT_EQ(run.find("sequential_s")->as_double(), 8);
  const auto as_written = json({"mission", "run", "m.yaml", "--clock", "virtual"});
  for (const auto* one : {&run, &as_written}) {
    EXPECT_EQ(one->find("outcome")->as_string(), "success") << "the mission's own, in either mode";
    EXPECT_EQ(*one->find("outputs")->find("pose"), type::Value(7));
    EXPECT_EQ(one->find("nodes")->as_list().at(0).find("status")->as_string(), "done");
    EXPECT_EQ(one->find("nodes")->as_list().at(0).find("outcome")->as_string(), "success");
    EXPECT_NE(one->find("globals"), nullptr);
  }
  const auto text = segue({"mission", "run", "m.yaml", "--mode", "concurrent", "--clock", "virtual"});
  EXPECT_THAT(text.output, HasSubstr("m: success\npose: 7\n"));
  EXPECT_EQ(segue({"mission", "run", "m.yaml", "--mode", "concurrent", "--start-at", "look"}).status, 1);
}

TEST_F(Missions, AMachineReportsTheFinalFacts) {
  write("m.yaml", R"j(mission: tidy
world: ["at(robot, dock)", "safe"]
actions:
  take: {inputs: {what: text}, effects: ["+held({what})", "-free"], run: {simulated: {duration: 1s}}}
  drop:
    outcomes: [dropped, stuck]
    expect: {outcome: dropped}
    inputs: {what: text}
    effects: ["-held({what})", "+free"]
    run: {simulated: {}}
  shake:
    outcomes: [dropped, stuck]
    expect: {outcome: dropped}
    effects: ["-held(pen)"]
    run: {simulated: {outcomes: [stuck]}}
start: cup
states:
  cup: {action: take, inputs: {what: cup}, on: {success: away}}
  away: {action: drop, inputs: {what: cup}, on: {dropped: pen, stuck: pen}}
  pen: {action: take, inputs: {what: pen}, on: {success: again}}
  again: {action: shake, on: {dropped: return success, stuck: return success}}
)j");
  const auto held_at_the_end = [&](const std::string& mode) {
    const auto run = json({"mission", "run", "m.yaml", "--clock", "virtual", "--mode", mode, "--fact", "lit",
                           "--fact", "!at(robot, dock)"});
    std::vector<std::string> facts;
    for (const auto& fact : run.find("world")->as_list())
      facts.push_back(fact.as_string());
    return facts;
  };
  // The cup was put away, the pen did not fall.
  EXPECT_THAT(held_at_the_end("sequential"), ::testing::ElementsAre("held(pen)", "lit()", "safe()"));
  EXPECT_THAT(held_at_the_end("concurrent"), ::testing::ElementsAre("held(pen)", "lit()", "safe()"));
  const auto odd = segue({"mission", "run", "m.yaml", "--fact", "+lit"});
  EXPECT_EQ(odd.status, 1);
  EXPECT_THAT(odd.errors, HasSubstr("'+lit' is not a fact"));
}

TEST_F(Missions, AMachineIsDrawnLikeATaskNetwork) {
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

TEST_F(Missions, TwoOutputsCannotShareAFile) {
  write("n.json", R"({"nodes": [{"name": "dig", "duration_s": 1}]})");
  const auto run = segue({"mission", "run", "n.json", "--clock", "virtual", "--svg", "x", "--html", "x"});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.errors, HasSubstr("'x' cannot be used for two outputs"));
}

TEST_F(Missions, UnwritableFilesAreReportedBeforeTheRun) {
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

class Interrupted : public Missions, public ::testing::WithParamInterface<int> {
 protected:
  /// Starts the command and signals it twice, as a terminal does, once it handles signals.
  Finished interrupt(std::vector<std::string> arguments) {
    Process process(command(std::move(arguments)), folder_);
    EXPECT_TRUE(process.wait_until_blocked(GetParam()));
    process.signal(GetParam());
    process.signal(GetParam());
    return process.wait();
  }
};

TEST_P(Interrupted, AMachineThatNeverEndsIsInterruptedCleanly) {
  write("m.yaml", kEndless);
  const auto run = interrupt({"mission", "run", "m.yaml", "--clock", "virtual", "--simulate"});
  EXPECT_EQ(run.status, 1) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("endless: preempted after"));
}

TEST_P(Interrupted, AConcurrentMachineIsInterruptedCleanly) {
  write("m.yaml", kOneHour);
  const auto run = interrupt({"mission", "run", "m.yaml", "--mode", "concurrent"});
  EXPECT_EQ(run.status, 1) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("hour: preempted"));
}

TEST_P(Interrupted, ATaskNetworkReportsItsProgress) {
  write("n.json", kLong);
  for (const std::string mode : {"sequential", "concurrent"}) {
    const auto run =
        interrupt({"mission", "run", "n.json", "--mode", mode, "--html", mode, "--format", "json"});
    EXPECT_EQ(run.status, 1) << mode << run.errors;
    const auto told = type::parse_json(run.output);
    ASSERT_TRUE(told) << mode << run.output;
    EXPECT_EQ(told->find("outcome")->as_string(), "stopped");
    const auto& nodes = told->find("nodes")->as_list();
    EXPECT_NE(nodes.at(1).find("status")->as_string(), "done") << mode;
    EXPECT_EQ(nodes.at(2).find("status")->as_string(), "not reached") << mode;
    EXPECT_THAT(read(mode), HasSubstr("</html>")) << "what was asked for is written";
  }
}
INSTANTIATE_TEST_SUITE_P(By, Interrupted, ::testing::Values(SIGINT, SIGTERM));

TEST_F(Missions, AFullDiskIsReportedAndLeavesNothing) {
  write("m.yaml", kTwoHands);
  write("n.json", kLong);
  const auto count_files = [this] { return std::distance(std::filesystem::directory_iterator(folder_), {}); };
  const auto before = count_files();
  for (const std::string file : {"m.yaml", "n.json"}) {
    for (const std::string option : {"--svg", "--html", "--trace"}) {
      const FullDisk full(100);
      const auto run =
          segue({"mission", "run", file, "--clock", "virtual", option, "out", "--format", "json"});
      EXPECT_EQ(run.status, 1) << file << ' ' << option;
      EXPECT_THAT(run.errors, HasSubstr("cannot write 'out': File too large"));
      EXPECT_TRUE(type::parse_json(run.output)) << "the run itself is shown";
      EXPECT_EQ(count_files(), before);
    }
  }
}

}  // namespace
}  // namespace segue::testing
