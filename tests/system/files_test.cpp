// SPDX-License-Identifier: Apache-2.0
#include "files_test_support.hpp"

namespace segue::testing {
namespace {

TEST_F(Files, TheVersionIsPrinted) {
  const auto finished = segue({"--version"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.output.rfind("segue ", 0), 0U) << finished.output;
}

TEST_F(Files, EveryVerbHasAnExampleInItsHelp) {
  for (const std::string verb :
       {"init",   "check",   "diff",    "predict",      "run",       "plan",      "apply",
        "switch", "prepare", "status",  "top",          "task",      "read",      "set",
        "call",   "events",  "history", "reset-belief", "component", "completion"}) {
    const auto finished = segue({verb, "--help"});
    EXPECT_EQ(finished.status, 0) << verb;
    EXPECT_TRUE(contains(finished.output, "Example:\n  s")) << verb << finished.output;
    EXPECT_TRUE(contains(segue({"--help"}).output, "  " + verb + " ")) << verb;
  }
}

TEST_F(Files, WrongUsageExitsWithTwoAndASuggestion) {
  const auto verb = segue({"chekc", "one.yaml"});
  EXPECT_EQ(verb.status, 2);
  EXPECT_TRUE(contains(verb.errors, "no verb 'chekc', did you mean 'check'?")) << verb.errors;
  const auto option = segue({"check", "--structur", "one.yaml"});
  EXPECT_EQ(option.status, 2);
  EXPECT_TRUE(contains(option.errors, "did you mean '--structure'?")) << option.errors;
  const auto missing = segue({"diff", "one.yaml"});
  EXPECT_EQ(missing.status, 2);
  EXPECT_TRUE(contains(missing.errors, "TARGET is required")) << missing.errors;
  const auto target = segue({"switch"});
  EXPECT_EQ(target.status, 2);
  EXPECT_TRUE(contains(target.errors, "NAME, --network FILE or --transition NAME|FILE")) << target.errors;
  EXPECT_EQ(segue({"switch", "one", "--transition", "t.yaml"}).status, 2);
  EXPECT_EQ(segue({"switch", "--transition", "t.yaml", "--dry-run"}).status, 2);
  EXPECT_EQ(segue({"run", "robot.yaml", "--log-level", "loud"}).status, 2);
  EXPECT_EQ(segue({}).status, 2);
  EXPECT_EQ(segue({"component", "lst"}).status, 2);
  EXPECT_EQ(segue({"read", "a.b", "--for", "ten"}).status, 2);
  EXPECT_EQ(segue({"diff", "one.yaml", "two.yaml", "--order", "fast"}).status, 2);
}

/// Every verb that needs no robot, with all that it can print.
TEST_F(Files, EveryVerbPrintsJsonWhereItIsAsked) {
  write("m.yaml",
        "mission: m\nactions: {a: {run: {simulated: {duration: 1s}}}}\nstart: s\n"
        "states: {s: {action: a, on: {success: return success}}}\n");
  ASSERT_EQ(segue({"diff", "two.yaml", "one.yaml", "-o", "t.yaml"}).status, 0);
  const std::vector<std::vector<std::string>> lines = {
      {"init", "fresh"},
      {"completion", "bash"},
      {"check", "one.yaml"},
      {"diff", "two.yaml", "one.yaml"},
      {"diff", "two.yaml", "one.yaml", "--svg"},
      {"diff", "two.yaml", "one.yaml", "--dot"},
      {"diff", "two.yaml", "one.yaml", "-o", "again.yaml"},
      {"predict", "two.yaml", "t.yaml"},
      {"predict", "two.yaml", "t.yaml", "-o", "applied.yaml"},
      {"component", "list"},
      {"component", "show", "demo::Drive"},
      {"component", "export", "segue_components_demo"},
      {"component", "export", "segue_components_demo", "-o", "exported.yaml"},
      {"mission", "run", "m.yaml", "--clock", "virtual"},
      {"mission", "run", "m.yaml", "--clock", "virtual", "--svg", "run.svg"},
      {"mission", "check", "m.yaml"},
      {"mission", "gantt", "m.yaml"},
      {"mission", "gantt", "m.yaml", "-o", "m.svg"},
      {"mission", "convert", "m.yaml"},
      {"mission", "convert", "m.yaml", "--svg"},
      {"mission", "convert", "m.yaml", "--dot"},
      {"mission", "convert", "m.yaml", "--svg", "-o", "c.svg"},
      {"mission", "import", "--rafcon", segue::paths::in_sources("/tests/rafcon/race")},
      {"mission", "import", "--rafcon", segue::paths::in_sources("/tests/rafcon/race"), "-o", "race.yaml"}};
  for (const auto& arguments : lines) {
    const auto value = json(arguments);
    EXPECT_TRUE(value.is_map() || value.is_list()) << arguments[0] << ' ' << arguments[1];
  }
}

/// Drawings beside the JSON of a run would make the output none.
TEST_F(Files, JsonSharesTheOutputWithNoDrawing) {
  write("n.json", R"({"nodes": [{"name": "a", "duration_s": 1}]})");
  EXPECT_TRUE(json({"mission", "run", "n.json", "--clock", "virtual", "--svg", "-"}, 1).find("error") !=
              nullptr);
}

TEST_F(Files, EveryVerbKnowsTheFormat) {
  const auto verbs_of = [&](const std::vector<std::string>& parent) {
    std::vector<std::string> words = parent;
    words.emplace_back("--help");
    std::istringstream help(segue(words).output);
    std::vector<std::string> verbs;
    bool listed = false;
    for (std::string line; std::getline(help, line);) {
      if (!line.empty() && line[0] != ' ') listed = line == "Subcommands:";
      if (listed && line.starts_with("  ") && line.size() > 2 && line[2] != ' ')
        verbs.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    return verbs;
  };
  std::size_t seen = 0;
  for (const std::string& verb : verbs_of({})) {
    std::vector<std::vector<std::string>> lines = {{verb}};
    if (const auto inner = verbs_of({verb}); !inner.empty()) {
      lines.clear();
      for (const std::string& name : inner)
        lines.push_back({verb, name});
    }
    for (auto& line : lines) {
      ++seen;
      line.emplace_back("--help");
      EXPECT_TRUE(contains(segue(line).output, "--format")) << verb << ' ' << line[1];
    }
  }
  EXPECT_GT(seen, 25U);
}

TEST_F(Files, NumbersAndDurationsOutsideTheirRangeAreRefused) {
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"read", "a.b", "-n", "0"},
                                             {"read", "a.b", "--count=-1"},
                                             {"read", "a.b", "-n", "99999999999999999999999"},
                                             {"read", "a.b", "--for", "0s"},
                                             {"read", "a.b", "--timeout=-1s"},
                                             {"read", "a.b", "--timeout", "900000h"},
                                             {"history", "-n", "0"},
                                             {"history", "--lines=-3"},
                                             {"log", "p", "--lines=-3"},
                                             {"log", "p", "-n", "99999999999999"},
                                             {"top", "--interval", "0s"},
                                             {"top", "--interval=-1s"},
                                             {"top", "--interval", "900000h"},
                                             {"events", "--after=-1"},
                                             {"events", "--after", "99999999999999999999999"},
                                             {"mission", "run", "n.json", "--seed=-1"},
                                             {"mission", "run", "n.json", "--workers", "5000000000"},
                                             {"run", "robot.yaml", "--for", "0s"}}) {
    const auto finished = segue(arguments);
    EXPECT_EQ(finished.status, 2) << arguments[0] << ' ' << arguments.back() << finished.errors;
  }
}

TEST_F(Files, OptionsThatMeanNothingForAFileAreRefused) {
  write("m.yaml",
        "mission: m\nactions: {a: {run: {simulated: {duration: 1s}}}}\nstart: s\n"
        "states: {s: {action: a, on: {success: return success}}}\n");
  write("n.json", R"({"nodes": [{"name": "a", "duration_s": 1}]})");
  EXPECT_EQ(segue({"mission", "run", "m.yaml", "--clock", "virtual"}).status, 0);
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--mode", "concurrent", "--order", "goal"},
                                             {"--order", "goal"},
                                             {"--world-copies", "2"},
                                             {"--workers", "2"},
                                             {"--ahead", "2"},
                                             {"--likelihood", "0.2"},
                                             {"--strict"}}) {
    std::vector<std::string> arguments = {"mission", "run", "m.yaml", "--clock", "virtual"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto finished = segue(arguments);
    EXPECT_EQ(finished.status, 1) << more[0];
    EXPECT_TRUE(contains(finished.errors, " for ")) << finished.errors;
  }
  for (const char* file : {"m.yaml", "n.json"}) {
    for (const char* mode : {"sequential", "concurrent"}) {
      const auto finished =
          segue({"mission", "run", file, "--clock", "virtual", "--mode", mode, "--resource", "nonsense=3"});
      EXPECT_EQ(finished.status, 1);
      EXPECT_TRUE(contains(finished.errors, "a resource 'nonsense'")) << finished.errors;
    }
  }
  EXPECT_EQ(segue({"mission", "run", "n.json", "--clock", "virtual", "--start-at", "a"}).status, 1);
  EXPECT_EQ(segue({"mission", "convert", "m.yaml", "--order", "goal"}).status, 1);
}

TEST_F(Files, OtherFilesThanNetworksAreRefusedByName) {
  write("robot.yaml", "robot: r\nlibraries: [segue_components_demo]\ncontrollers: [one.yaml]\n");
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"diff", "robot.yaml", "one.yaml"},
                                                                     {"diff", "one.yaml", "robot.yaml"},
                                                                     {"predict", "robot.yaml", "t.yaml"}}) {
    const auto finished = segue(arguments);
    EXPECT_EQ(finished.status, 1);
    EXPECT_TRUE(contains(finished.errors, "this is a robot file, not a network")) << finished.errors;
    EXPECT_FALSE(contains(finished.errors, "unknown-key")) << finished.errors;
  }
}

TEST_F(Files, CheckFindsNothingInGoodFiles) {
  EXPECT_EQ(segue({"check", "one.yaml", "two.yaml"}).status, 0);
  EXPECT_EQ(*json({"check", "one.yaml"}).find("ok"), Value(true));
}

TEST_F(Files, AFileThatIsTooLargeIsRefusedByEveryReader) {
  const std::string filler((std::size_t{17} << 20), '\n');
  write("large.yaml", kOne + filler);
  write("mission.yaml", "mission: m\naction: a\n" + filler);
  write("nodes.json", R"({"nodes": []})" + filler);
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"check", "large.yaml"},
                                             {"diff", "-", "large.yaml"},
                                             {"mission", "run", "mission.yaml"},
                                             {"mission", "run", "nodes.json"}}) {
    const auto finished = segue(command);
    EXPECT_EQ(finished.status, 1) << command.back();
    EXPECT_TRUE(contains(finished.errors, "larger than 16MiB")) << finished.errors;
    EXPECT_TRUE(contains(finished.errors, "SEGUE_MAX_FILE_SIZE")) << finished.errors;
  }
}

TEST_F(Files, CheckReportsEveryProblemWithItsLocation) {
  write("bad.yaml",
        "network: bad\ntasks:\n  a: {component: \"demo::Drvie\"}\n  b: {component: \"demo::Odometry\"}\n"
        "connections:\n  - c.velocity -> b.velocity\n  - b.psoe -> b.velocity\n");
  const auto result = json({"check", "bad.yaml"}, 1);
  EXPECT_EQ(*result.find("ok"), Value(false));
  const auto& items = result.find("diagnostics")->as_list();
  EXPECT_GE(items.size(), 3U);
  for (const Value& item : items) {
    EXPECT_EQ(item.find("file")->as_string(), "bad.yaml");
    EXPECT_GT(item.find("line")->as_int(), 1);
  }
  const auto text = segue({"check", "bad.yaml"});
  EXPECT_EQ(text.status, 1);
  EXPECT_TRUE(contains(text.errors, "bad.yaml:3:")) << text.errors;
  EXPECT_TRUE(contains(text.errors, "did you mean 'demo::Drive'?")) << text.errors;
}

TEST_F(Files, AMisspeltKeyIsAnErrorForEveryVerb) {
  write("misspelt.yaml",
        "network: misspelt\ntasks:\n  a: {component: \"demo::Drive\"}\n  b: {component: \"demo::Odometry\"}\n"
        "conections: [a.velocity -> b.velocity]\n");
  write("robot.yaml", "robot: r\nlibraries: [segue_components_demo]\ncontrollers: [misspelt.yaml]\n");
  write("tasks.json", R"({"nodes": [{"name": "a", "durations_s": 1, "x-colour": "red"}], "x-by": "hand"})");
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"check", "misspelt.yaml"},
                                                                     {"check", "robot.yaml"},
                                                                     {"diff", "empty", "misspelt.yaml"},
                                                                     {"run", "robot.yaml"}}) {
    const auto finished = segue(arguments);
    EXPECT_EQ(finished.status, 1) << arguments.front();
    EXPECT_TRUE(contains(finished.errors, "misspelt.yaml:5:")) << finished.errors;
    EXPECT_TRUE(contains(finished.errors, "did you mean 'connections'?")) << finished.errors;
  }
  const auto network = segue({"mission", "check", "tasks.json"});
  EXPECT_EQ(network.status, 1);
  EXPECT_TRUE(contains(network.errors, "did you mean 'duration_s'?")) << network.errors;
  EXPECT_FALSE(contains(network.errors, "x-")) << network.errors;
}

TEST_F(Files, CheckOfUnknownComponentsChecksTheStructureAndSaysSo) {
  write("foreign.yaml", "network: foreign\ntasks:\n  a: {component: \"elsewhere::Camera\"}\n");
  const auto finished = segue({"check", "foreign.yaml"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_TRUE(contains(finished.errors, "only its structure was checked")) << finished.errors;
}

TEST_F(Files, ModelsOfOtherLibrariesAreKnownIfTheyAreNamed) {
  write("models/camera.yaml", "components:\n  elsewhere::Camera:\n    ports: []\n");
  write("foreign.yaml", "network: foreign\ntasks:\n  a: {component: \"elsewhere::Camera\"}\n");
  const auto known = segue({"check", "--models", "models/*.yaml", "foreign.yaml", "one.yaml"});
  EXPECT_EQ(known.status, 0) << known.errors;
  EXPECT_TRUE(contains(known.output, "2 files: no problems")) << known.output;
  EXPECT_EQ(known.errors, "");
  EXPECT_EQ(segue({"check", "--models", "nowhere/*.yaml", "foreign.yaml"}).status, 1);
}

TEST_F(Files, CheckOfFilesThatCannotBeReadFails) {
  EXPECT_EQ(segue({"check", "nowhere.yaml"}).status, 1);
  write("noise.txt", "nothing of ours");
  const auto finished = segue({"check", "noise.txt"});
  EXPECT_EQ(finished.status, 1);
  EXPECT_TRUE(contains(finished.errors, "noise.txt")) << finished.errors;
  write("broken.yaml", "network: [\n");
  EXPECT_EQ(segue({"check", "broken.yaml"}).status, 1);
}

TEST_F(Files, ErrorsOfStructureDoNotHideThoseOfReferences) {
  write("both.yaml",
        "network: both\n"
        "tasks:\n"
        "  drive: {component: \"demo::Drive\", state: runing}\n"
        "  laser: {component: \"demo::LaserScaner\"}\n"
        "  nothing: {}\n"
        "connections:\n"
        "  - laser.scan -> guard.scan\n"
        "  - drive.velocty -> drive.command\n"
        "  - {from: drive.velocity}\n"
        "conections: []\n");
  const auto both = segue({"check", "both.yaml"});
  EXPECT_EQ(both.status, 1);
  for (const char* part :
       {"both.yaml:3:", "[bad-state]", "both.yaml:4:",
        "there is no component 'demo::LaserScaner', did you mean", "both.yaml:5:", "[missing-key]",
        "both.yaml:7:", "the network has no task 'guard'", "both.yaml:8:", "did you mean 'velocity'",
        "both.yaml:9:", "both.yaml:10:", "did you mean 'connections'", "1 file: 7 errors, 0 warnings"})
    EXPECT_TRUE(contains(both.errors + both.output, part)) << part << " in\n" << both.errors << both.output;
}

TEST_F(Files, ARobotFileWithErrorsDoesNotHideThoseOfItsControllers) {
  write("robot.yaml", "robot: r\nfallback: one\ncontrollers: [net/*.yaml]\npolicies: {watch: 0s}\n");
  write("net/one.yaml", "network: one\ntasks: {drive: {component: \"demo::Driv\"}}\n");
  write("net/two.yaml",
        "network: two\ntasks: {a: {component: \"demo::Drive\", stat: stopped}}\n"
        "connections: [a.velocity -> b.velocity]\n");
  const auto found = segue({"check", "robot.yaml"});
  EXPECT_EQ(found.status, 1);
  for (const char* part :
       {"robot.yaml:4:", "net/one.yaml:2:", "'demo::Driv', did you mean",
        "net/two.yaml:2:", "did you mean 'state'", "net/two.yaml:3:", "no task 'b'", "3 files: 4 errors"})
    EXPECT_TRUE(contains(found.errors + found.output, part)) << part << " in\n"
                                                             << found.errors << found.output;
  write("net/one.yaml", "network: [one\n");
  EXPECT_FALSE(contains(segue({"check", "robot.yaml"}).errors, "the fallback"))
      << "it may be what cannot be read";
}

TEST_F(Files, PredictGivesTheTargetOfADiff) {
  ASSERT_EQ(segue({"diff", "two.yaml", "one.yaml", "-o", "t.yaml"}).status, 0);
  EXPECT_EQ(segue({"check", "t.yaml"}).status, 0);
  const auto predicted = segue({"predict", "two.yaml", "t.yaml"});
  ASSERT_EQ(predicted.status, 0) << predicted.errors;
  write("predicted.yaml", predicted.output);
  const auto left = json({"diff", "predicted.yaml", "one.yaml"});
  EXPECT_EQ(*left.find("counts")->find("total"), Value(0));
  EXPECT_TRUE(json({"predict", "two.yaml", "t.yaml"}).find("tasks")->is_map());
}

TEST_F(Files, ATransitionThatDoesNotFitIsRefused) {
  ASSERT_EQ(segue({"diff", "two.yaml", "one.yaml", "-o", "t.yaml"}).status, 0);
  const auto refused = segue({"predict", "one.yaml", "t.yaml"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_FALSE(refused.errors.empty());
}

TEST_F(Files, InitCreatesARobotThatChecks) {
  const auto made = segue({"init", "rover", "--library"});
  ASSERT_EQ(made.status, 0) << made.errors;
  const auto checked = segue({"check", "rover/robot.yaml"});
  EXPECT_EQ(checked.status, 0) << checked.errors;
  EXPECT_EQ(checked.errors, "");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "rover/components/CMakeLists.txt"));
  const auto again = segue({"init", "rover"});
  EXPECT_EQ(again.status, 1);
  EXPECT_TRUE(contains(again.errors, "not an empty folder")) << again.errors;
}

TEST_F(Files, ComponentsAreListedShownAndExported) {
  EXPECT_TRUE(contains(segue({"component", "list"}).output, "demo::Drive"));
  EXPECT_TRUE(json({"component", "list"}).is_list());
  const auto shown = segue({"component", "show", "demo::Drive"});
  EXPECT_EQ(shown.status, 0);
  EXPECT_TRUE(contains(shown.output, "max_speed")) << shown.output;
  const auto unknown = segue({"component", "show", "demo::Drvie"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_TRUE(contains(unknown.errors, "did you mean 'demo::Drive'?")) << unknown.errors;
  const auto exported = segue({"component", "export", "segue_components_demo", "-o", "demo.components.yaml"});
  ASSERT_EQ(exported.status, 0) << exported.errors;
  EXPECT_EQ(segue({"check", "demo.components.yaml"}).status, 0);
  EXPECT_EQ(segue({"component", "export", "../evil"}).status, 1);
}

TEST_F(Files, CompletionScriptsLoadAndKnowEveryVerb) {
  const auto bash = segue({"completion", "bash"});
  ASSERT_EQ(bash.status, 0);
  write("completion.bash", bash.output);
  EXPECT_EQ(run({"/bin/bash", "-n", "completion.bash"}, folder_).status, 0);
  const auto completed = run({"/bin/bash", "-c",
                              "source completion.bash; COMP_WORDS=(segue sta); COMP_CWORD=1; _segue; "
                              "echo \"${COMPREPLY[*]}\""},
                             folder_);
  EXPECT_EQ(completed.output, "status\n") << completed.errors;
  const auto options = run({"/bin/bash", "-c",
                            "source completion.bash; COMP_WORDS=(segue read --fol); COMP_CWORD=2; _segue; "
                            "echo \"${COMPREPLY[*]}\"; COMP_WORDS=(segue mission ''); _segue; "
                            "echo \"${COMPREPLY[*]}\""},
                           folder_);
  EXPECT_TRUE(options.output.starts_with("--follow\n")) << options.output << options.errors;
  EXPECT_TRUE(contains(options.output, "run ")) << options.output;
  EXPECT_FALSE(contains(options.output, "--help")) << "names come first";
  const auto inner = run(
      {"/bin/bash", "-c",
       "source completion.bash; segue() { test \"$*\" = 'complete-names ros2-nodes' && echo /lidar /slam; }; "
       "COMP_WORDS=(segue ros2 describe /l); COMP_CWORD=3; _segue; echo \"${COMPREPLY[*]}\"; "
       "COMP_WORDS=(segue import ros2 --run); _segue; echo \"${COMPREPLY[*]}\"; "
       "COMP_WORDS=(segue ros2 nodes ''); _segue; echo \"${COMPREPLY[*]}\"; "
       "segue() { test \"$*\" = 'complete-names ros2-topics' && echo /scan /tf; }; "
       "COMP_WORDS=(segue ros2 topics /s); _segue; echo \"${COMPREPLY[*]}\""},
      folder_);
  EXPECT_EQ(inner.output, "/lidar\n--running\n\n/scan\n") << inner.errors;
  EXPECT_TRUE(contains(segue({"complete-names", "ros2-interfaces"}).output, "std_srvs/srv/SetBool\n"));
  EXPECT_TRUE(contains(segue({"complete-names", "ros2-packages"}).output, "sensor_msgs\n"));
  const auto zsh = segue({"completion", "zsh"});
  const auto fish = segue({"completion", "fish"});
  for (const std::string& script : {zsh.output, fish.output})
    EXPECT_TRUE(contains(script, "ros2-nodes")) << script;
  write("segue.fish", fish.output);
  if (std::filesystem::exists("/usr/bin/fish")) {
    const auto checked = run({"/usr/bin/fish", "--no-execute", "segue.fish"}, folder_);
    EXPECT_EQ(checked.status, 0) << checked.errors;
  }
  for (const std::string verb :
       {"init",   "check",   "diff",    "predict",      "run",       "plan",      "apply",
        "switch", "prepare", "status",  "top",          "task",      "read",      "set",
        "call",   "events",  "history", "reset-belief", "component", "completion"}) {
    EXPECT_TRUE(contains(bash.output, "    " + verb + ") ")) << verb;
    EXPECT_TRUE(contains(zsh.output, "    " + verb + ") ")) << verb;
    EXPECT_TRUE(contains(fish.output, " -a " + verb + " -d ")) << verb;
  }
}

TEST_F(Files, VerbsThatNeedARuntimeFailWithoutOne) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"status"},
                                                                     {"top"},
                                                                     {"switch", "one"},
                                                                     {"prepare", "one"},
                                                                     {"switch", "--transition", "t.yaml"},
                                                                     {"switch", "--network", "one.yaml"},
                                                                     {"plan"},
                                                                     {"apply"},
                                                                     {"reset-belief"},
                                                                     {"task", "a"},
                                                                     {"read", "a.b"},
                                                                     {"set", "a.b=1"},
                                                                     {"call", "a.b"},
                                                                     {"events"},
                                                                     {"history"},
                                                                     {"status", "--robot", "rover"}}) {
    const auto finished = segue(arguments);
    EXPECT_EQ(finished.status, 3) << arguments.front();
    EXPECT_TRUE(contains(finished.errors, "segue run")) << finished.errors;
  }
}

}  // namespace
}  // namespace segue::testing
