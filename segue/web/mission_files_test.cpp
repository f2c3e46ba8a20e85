// SPDX-License-Identifier: Apache-2.0
#include <segue/web/file_verbs_test_support.hpp>

#include <sys/stat.h>

namespace segue::web {
namespace {

namespace fs = std::filesystem;
using type::Value;

constexpr std::string_view kMission = R"(mission: fetch
actions:
  look: {outcomes: [found, nothing], run: {simulated: {duration: 1s}}}
start: look
states:
  look: {on: {found: return success, nothing: grasp}}
  grasp: {library: tools/grasp, on: {success: return success}}
)";
constexpr std::string_view kLibrary = R"(mission: grasp
inputs: {pose: {type: map, default: {x: 1}}}
outputs: {held: bool}
description: takes a thing
actions: {close: {run: {simulated: {duration: 1s}}}}
start: close
states: {close: {on: {success: return success}}}
)";

class MissionFilesTest : public RobotFilesTest {
 protected:
  MissionFilesTest() : RobotFilesTest({}) {}

  void SetUp() override {
    RobotFilesTest::SetUp();
    fs::create_directories(home_ / "missions" / "tools");
    fs::create_directories(home_ / ".hidden");
    fs::create_directories(home_ / "networks");
    write("robot.yaml", "robot: fake\ncontrollers: [networks/*.yaml, other.yaml]\n");
    write("networks/a.yaml", "network: a\ntasks: {}\n");
    write("missions/fetch.yaml", kMission);
    write("missions/tools/grasp.yaml", kLibrary);
    write(".hidden/fetch.yaml", kMission);
    write("notes.yaml", "secret: 1\n");
    write("../outside.yaml", kMission);
    fs::create_symlink(home_ / "missions" / "fetch.yaml", home_ / "missions" / "link.yaml");
    fs::create_directory_symlink(folder_, home_ / "up");
  }
  std::string version(const std::string& path) {
    const Value file = result("read_file", Value::map({{"path", path}}), Role::Observe);
    return file.find("version")->as_string();
  }
  std::map<std::string, std::string> listed() {
    std::map<std::string, std::string> found;
    const Value answer = result("files", Value(type::ValueMap{}), Role::Observe);
    for (const Value& file : answer.find("files")->as_list())
      found[file.find("path")->as_string()] = file.find("kind")->as_string();
    return found;
  }
  std::vector<std::string> problems(const std::string& path, const std::string& text) {
    std::vector<std::string> found;
    const Value answer = result("check_file", Value::map({{"path", path}, {"text", text}}), Role::Observe);
    for (const Value& one : answer.find("problems")->as_list())
      found.push_back(one.find("code")->as_string() + " " + std::to_string(one.find("line")->as_int()));
    return found;
  }
  /// A machine of RAFCON with one state that uses a library.
  void write_machine() const {
    constexpr std::string_view kMachine = R"({"used_rafcon_version": "2.4.0"})";
    constexpr std::string_view kLeaf =
        R"({"__jsonqualname__": "rafcon.core.states.execution_state.ExecutionState", "state_id": "ABC",
            "name": "say", "description": null, "input_data_ports": {}, "output_data_ports": {},
            "outcomes": {"0": {"__jsonqualname__": "rafcon.core.state_elements.logical_port.Outcome",
                               "outcome_id": 0, "name": "success"}}})";
    fs::create_directories(home_ / "machines" / "say");
    write("machines/say/statemachine.json", kMachine);
    write("machines/say/core_data.json", kLeaf);
    write("machines/say/script.py", "def execute(self, inputs, outputs, gvm):\n    return 0\n");
  }
};

TEST_F(MissionFilesTest, MissionsInTheFolderOfTheRobotAreListedWithoutLinksAndHiddenFolders) {
  write_machine();
  EXPECT_EQ(listed(), (std::map<std::string, std::string>{{"robot.yaml", "robot"},
                                                          {"networks/a.yaml", "network"},
                                                          {"other.yaml", "network"},
                                                          {"missions/fetch.yaml", "mission"},
                                                          {"missions/tools/grasp.yaml", "mission"},
                                                          {"machines/say", "rafcon"}}));
}

TEST_F(MissionFilesTest, NoMoreMissionsAreListedThanPagesShow) {
  fs::create_directories(home_ / "many");
  for (std::size_t i = 0; i <= kMostListedFiles; ++i)
    write(fs::path("many") / (std::to_string(i) + ".yaml"), "mission: m\n");
  const Value answer = result("files", Value(type::ValueMap{}), Role::Observe);
  EXPECT_EQ(*answer.find("complete"), Value(false));
  EXPECT_EQ(answer.find("files")->as_list().size(), kMostListedFiles + 3) << "and those that are named";
}

TEST_F(MissionFilesTest, OnlyMissionsCanBeNamedSo) {
  for (const std::string path :
       {"notes.yaml", ".hidden/fetch.yaml", "missions/link.yaml", "up/outside.yaml", "up/home/robot.yaml",
        "../outside.yaml", "missions/../notes.yaml", "missions", "missions/tools", ""}) {
    EXPECT_NE(error("read_file", Value::map({{"path", path}})), "") << path;
    EXPECT_NE(error("save_file", Value::map({{"path", path}, {"text", kMission}, {"version", ""}})), "")
        << path;
    EXPECT_NE(error("rename_file", Value::map({{"path", path}, {"to", "x.yaml"}, {"version", ""}})), "")
        << path;
    EXPECT_NE(error("delete_file", Value::map({{"path", path}, {"version", ""}})), "") << path;
  }
  EXPECT_EQ(content("notes.yaml"), "secret: 1\n");
}

TEST_F(MissionFilesTest, AMissionIsReadCheckedAndSaved) {
  const std::string text(kMission);
  const std::string path = "missions/fetch.yaml";
  EXPECT_EQ(problems(path, text), std::vector<std::string>{});
  EXPECT_EQ(problems(path, text + "  odd: {}\n"),
            (std::vector<std::string>{"unreachable-state 8", "unknown-action 8"}));
  EXPECT_EQ(problems(path, "mission: [\n").size(), 1U);
  write("missions/tools/grasp.yaml", "mission: grasp\nstates: 7\n");
  const auto broken = problems(path, text);
  EXPECT_EQ(broken, (std::vector<std::string>{"wrong-kind 0", "missing-library 7"}))
      << "of the other file, which has no line here, and where it is used";
  const std::string before = version(path);
  result("save_file", Value::map({{"path", path}, {"text", text + "# edited\n"}, {"version", before}}));
  EXPECT_EQ(content(path), text + "# edited\n");
  EXPECT_EQ(error("save_file", Value::map({{"path", path}, {"text", text}, {"version", before}})),
            "invalid-state");
  EXPECT_EQ(
      error("save_file", Value::map({{"path", path}, {"text", "robot: no\n"}, {"version", version(path)}})),
      "invalid-argument");
  EXPECT_EQ(content(path), text + "# edited\n");
}

TEST_F(MissionFilesTest, WhatAMissionAsksOfTheRobotIsCheckedWhereTheRobotNamesIt) {
  const std::string text =
      "mission: m\nactions: {go: {run: {controller: nowhere, until: [{after: 1s}]}}}\n"
      "start: go\nstates: {go: {on: {success: return success}}}\n";
  write("missions/m.yaml", text);
  fs::remove(home_ / "missions" / "link.yaml");
  EXPECT_EQ(problems("missions/m.yaml", text), std::vector<std::string>{});
  write("robot.yaml", "robot: fake\ncontrollers: [networks/*.yaml]\nmissions: [missions/*.yaml]\n");
  const auto found = problems("missions/m.yaml", text);
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(found[0].ends_with(" 2")) << found[0];
}

TEST_F(MissionFilesTest, LibrariesSayTheirInterface) {
  const Value answer = result("libraries", Value::map({{"path", "missions/fetch.yaml"}}), Role::Observe);
  const auto& list = answer.find("libraries")->as_list();
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(*list[0].find("name"), Value("tools/grasp"));
  EXPECT_EQ(*list[0].find("description"), Value("takes a thing"));
  EXPECT_EQ(*list[0].find("inputs")->as_list().at(0).find("type"), Value("map"));
  EXPECT_EQ(*list[0].find("outcomes"), Value(Value::List{Value("success")}));
}

TEST_F(MissionFilesTest, NewFilesTakeNobodysPlace) {
  result("create_file", Value::map({{"path", "missions/new.yaml"}, {"text", kLibrary}}));
  EXPECT_EQ(content("missions/new.yaml"), kLibrary);
  EXPECT_EQ(error("create_file", Value::map({{"path", "missions/new.yaml"}, {"text", kMission}})),
            "already-exists");
  EXPECT_EQ(error("create_file", Value::map({{"path", "missions/link.yaml"}, {"text", kMission}})),
            "already-exists");
  EXPECT_EQ(content("missions/new.yaml"), kLibrary);
  EXPECT_EQ(content("missions/fetch.yaml"), kMission);
  for (const std::string path :
       {"../x.yaml", "/tmp/x.yaml", "x", "x.py", "a b.yaml", ".x.yaml", "missions/.x.yaml",
        "missions//x.yaml", "<i>.yaml", "missions/../x.yaml", "./x.yaml", "", ".yaml"})
    EXPECT_EQ(error("create_file", Value::map({{"path", path}, {"text", kMission}})), "invalid-argument")
        << path;
  EXPECT_EQ(error("create_file", Value::map({{"path", "up/x.yaml"}, {"text", kMission}})),
            "permission-denied");
  EXPECT_EQ(error("create_file", Value::map({{"path", "nowhere/x.yaml"}, {"text", kMission}})), "not-found");
  EXPECT_EQ(error("create_file", Value::map({{"path", "x.yaml"}, {"text", "secret: 1\n"}})),
            "invalid-argument");
  EXPECT_EQ(error("create_file", Value::map({{"path", "x.yaml"}})), "invalid-argument");
  EXPECT_EQ(error("create_file",
                  Value::map({{"path", "x.yaml"}, {"text", kMission}, {"robot_text", "robot: r\n"}})),
            "invalid-argument");
  EXPECT_FALSE(fs::exists(home_ / "x.yaml"));
}

TEST_F(MissionFilesTest, ANewControllerIsNamedByTheRobotFileOrNotThere) {
  constexpr std::string_view kNew = "network: b\ntasks: {}\n";
  result("create_file", Value::map({{"path", "networks/b.yaml"}, {"text", kNew}}));
  EXPECT_EQ(listed().at("networks/b.yaml"), "network");
  EXPECT_EQ(error("create_file", Value::map({{"path", "c.yaml"}, {"text", kNew}})), "invalid-argument");
  EXPECT_FALSE(fs::exists(home_ / "c.yaml"));
  const std::string robot = "robot: fake\ncontrollers: [networks/*.yaml, c.yaml]\n";
  const std::string before = version("robot.yaml");
  EXPECT_EQ(
      error("create_file",
            Value::map(
                {{"path", "c.yaml"}, {"text", kNew}, {"robot_text", robot}, {"robot_version", "another"}})),
      "invalid-state");
  EXPECT_FALSE(fs::exists(home_ / "c.yaml")) << "the robot file had changed meanwhile";
  result("create_file",
         Value::map({{"path", "c.yaml"}, {"text", kNew}, {"robot_text", robot}, {"robot_version", before}}));
  EXPECT_EQ(content("robot.yaml"), robot);
  EXPECT_EQ(listed().at("c.yaml"), "network");
}

TEST_F(MissionFilesTest, FilesAreRenamedAndDeletedInTheVersionThatIsMeant) {
  const std::string path = "missions/fetch.yaml";
  EXPECT_EQ(error("rename_file", Value::map({{"path", path}, {"to", "missions/new.yaml"}, {"version", "x"}})),
            "invalid-state");
  EXPECT_EQ(
      error("rename_file",
            Value::map({{"path", path}, {"to", "missions/tools/grasp.yaml"}, {"version", version(path)}})),
      "already-exists");
  EXPECT_EQ(content("missions/tools/grasp.yaml"), kLibrary);
  EXPECT_EQ(
      error("rename_file", Value::map({{"path", path}, {"to", "../fetch.yaml"}, {"version", version(path)}})),
      "invalid-argument");
  result("rename_file",
         Value::map({{"path", path}, {"to", "missions/new.yaml"}, {"version", version(path)}}));
  EXPECT_EQ(content("missions/new.yaml"), kMission);
  EXPECT_FALSE(fs::exists(home_ / path));
  EXPECT_EQ(error("delete_file", Value::map({{"path", "missions/new.yaml"}, {"version", ""}})),
            "invalid-state");
  const std::string last = version("missions/new.yaml");
  result("delete_file", Value::map({{"path", "missions/new.yaml"}, {"version", last}}));
  EXPECT_FALSE(fs::exists(home_ / "missions/new.yaml"));
  EXPECT_EQ(error("delete_file", Value::map({{"path", "robot.yaml"}, {"version", version("robot.yaml")}})),
            "invalid-argument");
}

TEST_F(MissionFilesTest, AControllerStaysWhereTheRobotFileWouldNotNameItAnyMore) {
  const std::string path = "networks/a.yaml";
  EXPECT_EQ(error("rename_file", Value::map({{"path", path}, {"to", "a.yaml"}, {"version", version(path)}})),
            "invalid-argument");
  EXPECT_EQ(content(path), "network: a\ntasks: {}\n");
  EXPECT_FALSE(fs::exists(home_ / "a.yaml"));
  EXPECT_EQ(error("delete_file", Value::map({{"path", path},
                                             {"version", version(path)},
                                             {"robot_text", "robot: fake\n"},
                                             {"robot_version", "another"}})),
            "invalid-state");
  EXPECT_EQ(content(path), "network: a\ntasks: {}\n") << "it came back";
}

TEST_F(MissionFilesTest, AnObserverChangesNoFile) {
  const std::string path = "missions/fetch.yaml";
  const std::string before = version(path);
  const auto refused = [&](const std::string& verb, const Value& arguments) {
    EXPECT_EQ(error(verb, arguments, Role::Observe), "permission-denied") << verb;
  };
  refused("create_file", Value::map({{"path", "missions/new.yaml"}, {"text", kMission}}));
  refused("rename_file", Value::map({{"path", path}, {"to", "missions/new.yaml"}, {"version", before}}));
  refused("delete_file", Value::map({{"path", path}, {"version", before}}));
  refused("save_file", Value::map({{"path", path}, {"text", kMission}, {"version", before}}));
  EXPECT_EQ(content(path), kMission);
  EXPECT_FALSE(fs::exists(home_ / "missions/new.yaml"));
}

TEST_F(MissionFilesTest, AMachineOfRafconIsReadAsTheMissionThatItBecomes) {
  write_machine();
  const Value file = result("read_file", Value::map({{"path", "machines/say"}}), Role::Observe);
  const std::string text = file.find("text")->as_string();
  EXPECT_TRUE(text.starts_with("mission: ")) << text;
  EXPECT_NE(text.find("def execute"), std::string::npos);
  result("check_file", Value::map({{"path", "machines/say"}, {"text", text}}), Role::Observe);
  for (const std::string verb : {"save_file", "rename_file", "delete_file"}) {
    Value arguments = Value::map({{"path", "machines/say"}, {"version", ""}});
    if (verb == "save_file") arguments.as_map().set("text", text);
    if (verb == "rename_file") arguments.as_map().set("to", "x.yaml");
    EXPECT_EQ(error(verb, arguments), "unsupported") << verb;
  }
  result("create_file", Value::map({{"path", "missions/say.yaml"}, {"text", text}}));
  EXPECT_EQ(content("missions/say.yaml"), text);
}

TEST_F(MissionFilesTest, NoMachineReadsThroughLinks) {
  write_machine();
  write("../secret.py", "secret");
  fs::remove(home_ / "machines" / "say" / "script.py");
  fs::create_symlink(folder_ / "secret.py", home_ / "machines" / "say" / "script.py");
  const Value answer = ask("read_file", Value::map({{"path", "machines/say"}}), Role::Observe);
  EXPECT_NE(answer.find("error"), nullptr);
  EXPECT_EQ(type::to_json(answer, -1).find("secret\""), std::string::npos);
}

}  // namespace
}  // namespace segue::web
