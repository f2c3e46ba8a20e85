// SPDX-License-Identifier: Apache-2.0
#include <support/paths.hpp>

#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <sstream>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;
using type::Value;

/// Machines as RAFCON stores them.
const std::filesystem::path kMachines = segue::paths::in_sources("/tests/rafcon");
const std::string kOwnLibraries = "own=" + (kMachines / "libraries").string();

/// Whether the process has ended or is a zombie.
bool ended(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/stat");
  std::string number;
  std::string name;
  std::string state;
  return !(status >> number >> name >> state) || state == "Z";
}

class MissionScripts : public SystemTest {
 protected:
  Finished import(const std::filesystem::path& machine, const std::string& file) {
    return segue({"mission", "import", "--rafcon", machine, "--libraries", kOwnLibraries, "-o", file});
  }
  std::string read(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(MissionScripts, AnImportedMachineRunsWithItsScriptsAndLibraries) {
  const auto imported = import(kMachines / "count_down", "m.yaml");
  ASSERT_EQ(imported.status, 0) << imported.errors;
  EXPECT_THAT(imported.errors,
              HasSubstr("m.yaml: 4 states, 1 of them libraries, 4 transitions, 4 data flows"));
  const auto run = json({"mission", "run", "m.yaml"});
  EXPECT_EQ(run.find("outcome")->as_string(), "finished");
  EXPECT_EQ(run.find("nodes")->as_list().size(), 4U);
  EXPECT_EQ(*run.find("outputs")->find("left"), Value(0));
  EXPECT_EQ(*run.find("globals")->find("last"), Value(0));
  EXPECT_THAT(segue({"mission", "run", "m.yaml"}).errors, HasSubstr("info: show: left: 0\n"));
}

TEST_F(MissionScripts, AnImportedMachineRunsConcurrentlyAndDecides) {
  ASSERT_EQ(import(kMachines / "side_by_side", "m.yaml").status, 0);
  const auto run = json({"mission", "run", "m.yaml"});
  EXPECT_EQ(run.find("outcome")->as_string(), "success");
  const auto& right = run.find("nodes")->as_list()[1];
  EXPECT_EQ(right.find("status")->as_string(), "failed");
  EXPECT_EQ(right.find("outcome")->as_string(), "aborted");
  EXPECT_EQ(right.find("error")->as_string(), "barrier/right:3: RuntimeError: right fails");
}

TEST_F(MissionScripts, AMachineRunsFromItsFolderAsWell) {
  const auto folder = kMachines / "count_down";
  const auto run = json({"mission", "run", folder, "--libraries", kOwnLibraries});
  EXPECT_EQ(run.find("outcome")->as_string(), "finished");
  EXPECT_EQ(segue({"mission", "check", folder, "--libraries", kOwnLibraries}).status, 0);
  const auto alone = segue({"mission", "run", folder});
  EXPECT_EQ(alone.status, 1);
  EXPECT_THAT(alone.errors, HasSubstr("missing-library"));
  EXPECT_EQ(segue({"mission", "run", "."}).status, 1) << "no machine";
}

TEST_F(MissionScripts, AnImportGoesToStandardOutputWithoutAFile) {
  const auto imported =
      segue({"mission", "import", "--rafcon", kMachines / "count_down", "--libraries", kOwnLibraries});
  ASSERT_EQ(imported.status, 0) << imported.errors;
  EXPECT_EQ(imported.output.rfind("mission: Count_down\n", 0), 0U) << imported.output;
  write("m.yaml", imported.output);
  EXPECT_EQ(segue({"mission", "check", "m.yaml"}).status, 0);
}

TEST_F(MissionScripts, AnImportWithoutItsLibraryLeavesTheFileAlone) {
  write("m.yaml", "what was there\n");
  const auto imported = segue({"mission", "import", "--rafcon", kMachines / "count_down", "-o", "m.yaml"});
  EXPECT_EQ(imported.status, 1);
  EXPECT_THAT(imported.errors, HasSubstr("there is no library 'own/tools/show value'"));
  EXPECT_THAT(imported.errors, HasSubstr("missing-library"));
  EXPECT_EQ(read("m.yaml"), "what was there\n");
}

TEST_F(MissionScripts, AnImportOfADamagedMachineReportsTheLocation) {
  std::filesystem::copy(kMachines / "count_down", folder_ / "machine",
                        std::filesystem::copy_options::recursive);
  write("machine/core_data.json", "{\n  \"name\": oops\n}\n");
  const auto imported = import("machine", "m.yaml");
  EXPECT_EQ(imported.status, 1);
  EXPECT_THAT(imported.errors, HasSubstr("machine/core_data.json:2:"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "m.yaml"));
}

TEST_F(MissionScripts, AnImportReplacesAnEarlierOne) {
  ASSERT_EQ(import(kMachines / "side_by_side", "m.yaml").status, 0);
  ASSERT_EQ(import(kMachines / "count_down", "m.yaml").status, 0);
  EXPECT_THAT(read("m.yaml"), HasSubstr("mission: Count_down\n"));
}

TEST_F(MissionScripts, AnImportRequiresSourceAndTarget) {
  EXPECT_EQ(segue({"mission", "import", "-o", "m.yaml"}).status, 2);
  EXPECT_EQ(import("nowhere", "m.yaml").status, 1);
  const auto unwritable = import(kMachines / "side_by_side", "nowhere/m.yaml");
  EXPECT_EQ(unwritable.status, 1);
  EXPECT_THAT(unwritable.errors, HasSubstr("nowhere/m.yaml"));
}

TEST_F(MissionScripts, AnImportReportsWarningsOfTheNewFile) {
  const auto imported = import(kMachines / "renumbered", "m.yaml");
  EXPECT_EQ(imported.status, 0);
  EXPECT_THAT(imported.errors, HasSubstr("must return them by name"));
  EXPECT_EQ(json({"mission", "run", "m.yaml"}).find("outcome")->as_string(), "there");
}

/// How many control characters it has, other than line feeds and tabs; those of two bytes too.
std::size_t controls_in(const std::string& text) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7f) ++count;
    if (byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0) ++count;
  }
  return count;
}

/// A mission whose script is a file.
constexpr const char* kScripted =
    "mission: m\nactions: {work: {run: {python: scripts/work.py}}}\naction: work\n";

TEST_F(MissionScripts, ScriptsAreFoundBesideTheMissionAndTheirOutputIsSeparate) {
  write("plans/m.yaml", kScripted);
  write("plans/scripts/tools.py", "WORD = 'hello'\n");
  write("plans/scripts/work.py",
        "import tools\ndef execute(self, inputs, outputs, gvm):\n  print(tools.WORD)\n  return 0\n");
  EXPECT_EQ(json({"mission", "run", "plans/m.yaml"}).find("outcome")->as_string(), "success");
  EXPECT_THAT(segue({"mission", "run", "plans/m.yaml"}).errors, HasSubstr("hello"));
}

TEST_F(MissionScripts, NoControlCharacterOfAScriptReachesTheTerminal) {
  write("m.yaml", kScripted);
  write("scripts/work.py",
        "import os\nWIPE = '\\x1b[2J\\x9b2J\\r'\ndef execute(self, inputs, outputs, gvm):\n  print('said' + "
        "WIPE)\n"
        "  os.write(1, ('wrote' + WIPE + '\\n').encode())\n  self.logger.warning('logged' + WIPE)\n"
        "  raise ValueError('raised' + WIPE)\n");
  const auto run = segue({"mission", "run", "m.yaml"});
  for (const std::string text : {"said", "wrote", "logged", "raised"})
    EXPECT_THAT(run.output + run.errors, HasSubstr(text + "\\x1b[2J"));
  EXPECT_EQ(controls_in(run.output + run.errors), 0U) << run.output << run.errors;
}

TEST_F(MissionScripts, NoControlCharacterOfFilesReachesTheTerminal) {
  const std::string wipe =
      "\x1b[2J\xc2\x9b"
      "2J";
  const auto shown = [&](const Finished& finished) {
    EXPECT_THAT(finished.output + finished.errors, HasSubstr("\\x1b[2J"));
    EXPECT_EQ(controls_in(finished.output + finished.errors), 0U) << finished.output << finished.errors;
  };
  write("bad" + wipe + ".yaml", "mission: m\naction: nothing\n");
  shown(segue({"check", "bad" + wipe + ".yaml"}));
  shown(segue({"mission", "run", "bad" + wipe + ".yaml"}));
  shown(segue({"no verb" + wipe}));
  write("m.yaml", "mission: \"m\\e[2J\\x9b2J\"\naction: \"a\\e[2J\"\n");
  shown(segue({"mission", "check", "m.yaml"}));
}

TEST_F(MissionScripts, AScriptThatIsInterruptedEndsAsPreempted) {
  write("m.yaml", kScripted);
  write("scripts/work.py",
        "def execute(self, inputs, outputs, gvm):\n  open('works', 'w').close()\n"
        "  return 0 if self.preemptive_wait() else 'aborted'\n");
  Process run(command({"mission", "run", "m.yaml"}), folder_);
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder_ / "works"); }));
  run.signal(SIGINT);
  const auto finished = run.wait();
  EXPECT_EQ(finished.status, 1) << finished.errors;
  EXPECT_THAT(finished.output, HasSubstr("m: preempted after"));
}

TEST_F(MissionScripts, ScriptsEndWithAMissionThatIsKilled) {
  write("m.yaml", kScripted);
  // The second script holds the interpreter's lock: its process cannot notice the end of its parent.
  for (const std::string work : {"self.preemptive_wait()", "re.match('(a+)+$', 'a' * 100 + 'b')"}) {
    write("scripts/work.py",
          "import os, re\ndef execute(self, inputs, outputs, gvm):\n"
          "  with open('begins', 'w') as file: file.write(str(os.getpid()))\n"
          "  os.rename('begins', 'works')\n  " +
              work + "\n");
    Process run(command({"mission", "run", "m.yaml"}), folder_);
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder_ / "works"); }));
    const pid_t worker = std::stoi(read("works"));
    run.signal(SIGKILL);
    EXPECT_EQ(run.wait().status, 128 + SIGKILL);
    EXPECT_TRUE(eventually([&] { return ended(worker); })) << work;
    std::filesystem::remove(folder_ / "works");
  }
}

TEST_F(MissionScripts, AMissingInterpreterRefusesTheRun) {
  write("m.yaml", kScripted);
  const auto run = segue({"mission", "run", "m.yaml", "--python", "/nowhere/python3"});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.errors, HasSubstr("cannot find the Python interpreter '/nowhere/python3'"));
  EXPECT_EQ(segue({"mission", "run", "m.yaml", "--simulate"}).status, 0) << "needs none";
}

TEST_F(MissionScripts, ScriptsSeeTheWorldIfTheyDeclareIt) {
  write("m.yaml", R"x(
mission: m
world: ["at(box, floor)"]
actions:
  lift: {
  effects:
    [ "-at(box, floor)", "+at(box, table)" ], run : {
    simulated : {
    duration:
      10ms
    }
    }}
  look:
    outputs: {there: list}
    pure: true
    reads_world: true
    run:
      python:
        text: |
          def execute(self, inputs, outputs, gvm):
              outputs["there"] = sorted(self.world)
              return "success" if "at(box, table)" in self.world else "aborted"
  blind:
    outputs: {why: text}
    pure: true
    run:
      python:
        text: |
          def execute(self, inputs, outputs, gvm):
              try:
                  self.world
              except RuntimeError as error:
                  outputs["why"] = str(error)
              return "success"
outputs: {there: list, why: text}
start: lift
flows: [look.there -> outputs.there, blind.why -> outputs.why]
states:
  lift: {
  on : {
  success:
    look
  }}
  look: {
  on : {
  success:
    blind
  }}
  blind: {on: {success: return success}}
)x");
  for (const std::string mode : {"sequential", "concurrent"}) {
    const auto run = json({"mission", "run", "m.yaml", "--mode", mode});
    const Value& outputs = *run.find("outputs");
    EXPECT_EQ(*outputs.find("there"), Value(Value::List{Value("at(box,table)")})) << mode;
    EXPECT_EQ(*outputs.find("why"), Value("the action does not declare 'reads_world'"));
  }
}

TEST_F(MissionScripts, AKilledRunResumes) {
  write("m.yaml", R"(
mission: m
actions:
  count:
    inputs: {n: int}
    outputs: {n: int}
    outcomes: [more, enough]
    run:
      python:
        text: |
          def execute(self, inputs, outputs, gvm):
              with open("done.txt", "a") as file:
                  file.write("%d\n" % inputs["n"])
              gvm.set_variable("last", inputs["n"])
              outputs["n"] = inputs["n"] + 1
              return "more" if outputs["n"] < 5 else "enough"
  rest: {run: {simulated: {duration: 20ms}}}
variables: {n: {type: int, default: 0}}
start: count
flows: [variables.n -> count.n, count.n -> variables.n]
states:
  count: {on: {more: rest, enough: return success}}
  rest: {on: {success: count}}
)");
  for (const std::string mode : {"sequential", "concurrent"}) {
    const std::string other = mode == "sequential" ? "concurrent" : "sequential";
    const std::string journal = mode + ".journal";
    const std::vector<std::string> begun = {"mission", "run", "m.yaml", "--mode", mode, "--journal", journal};
    std::filesystem::remove(folder_ / "done.txt");
    {
      Process process(command(begun), folder_);
      ASSERT_TRUE(eventually([&] { return read(journal).find("\"ended\":\"rest\"") != std::string::npos; }));
      process.signal(SIGKILL);
      process.wait();
    }
    EXPECT_THAT(segue(begun).errors, HasSubstr("'" + journal + "' already exists"));
    auto resumed = begun;
    resumed[4] = other;
    resumed.emplace_back("--resume");
    EXPECT_THAT(segue(resumed).errors, HasSubstr("that run was a " + mode + " one: --mode " + mode));
    resumed = begun;
    resumed.insert(resumed.end(), {"--resume", "--under-way", "again"});
    const auto rest = json(resumed);
    EXPECT_EQ(rest.find("outcome")->as_string(), "success");
    EXPECT_EQ(*rest.find("globals")->find("last"), Value(4));
    std::map<std::string, int> lines;
    std::istringstream done(read("done.txt"));
    for (std::string line; std::getline(done, line);)
      ++lines[line];
    EXPECT_EQ(lines.size(), 5U);
    EXPECT_EQ(lines["0"], 1) << "it had ended";
    EXPECT_THAT(segue(resumed).errors, HasSubstr("that run has ended"));
  }
}

/// Notes what was done, in order, in data that follow facts. In the middle, the whole run is killed once.
constexpr const char* kNoted = R"j(mission: noted
world_data:
  notes: {initial: [], python: notes.py, effects: {"+done": add}}
actions:
  work: {inputs: {what: text}, effects: ["+done({what})"], run: {simulated: {duration: 1ms}}}
  crash:
    resources: [{block: crash}]
    run:
      python:
        text: |
          import os, signal
          def execute(self, inputs, outputs, gvm):
              if os.path.exists("crash"):
                  os.remove("crash")
                  os.kill(os.getppid(), signal.SIGKILL)
                  self.preemptive_wait()
              return "success"
  look:
    outputs: {notes: list}
    pure: true
    reads_world: true
    run:
      python:
        text: |
          def execute(self, inputs, outputs, gvm):
              outputs["notes"] = self.world.data["notes"]
              return "success"
outputs: {early: list, notes: list}
flows: [early.notes -> outputs.early, look.notes -> outputs.notes]
start: first
states:
  first: {action: work, inputs: {what: b}, on: {success: early}}
  early: {action: look, on: {success: crash}}
  crash: {on: {success: second}}
  second: {action: work, inputs: {what: a}, on: {success: look}}
  look: {on: {success: return success}}
)j";

TEST_F(MissionScripts, DataFollowFactsAlsoInARunThatIsResumed) {
  write("noted.yaml", kNoted);
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    write("crash", "");
    write("notes.py", "def add(notes, what):\n  notes.append(what)\n");
    const std::vector<std::string> run = {"mission", "run",       "noted.yaml", "--mode",
                                          mode,      "--journal", mode + ".db"};
    EXPECT_NE(segue(run).status, 0);
    auto resumed = run;
    resumed.insert(resumed.end(), {"--resume", "--under-way", "skip"});
    const auto ended = json(resumed);
    EXPECT_EQ(type::to_json(*ended.find("outputs"), -1), R"j({"early":["b"],"notes":["b","a"]})j");
    write("notes.py", "def add(notes, what):\n  notes.append(what / 2)\n");
    const auto wrong = segue({"mission", "run", "noted.yaml", "--mode", mode});
    EXPECT_EQ(wrong.status, 1);
    EXPECT_THAT(wrong.output + wrong.errors, HasSubstr("notes.py:2: TypeError: unsupported operand"));
    EXPECT_THAT(wrong.output + wrong.errors, HasSubstr("in add for +done(b)"));
  }
}

}  // namespace
}  // namespace segue::testing
