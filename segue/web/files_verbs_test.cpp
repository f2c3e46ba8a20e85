// SPDX-License-Identifier: Apache-2.0
#include <segue/model/files.hpp>
#include <segue/web/file_verbs_test_support.hpp>

#include <gmock/gmock.h>
#include <sys/stat.h>

namespace segue::web {
namespace {

namespace fs = std::filesystem;
using type::Value;

constexpr std::string_view kComponents = R"(components:
  t::Source:
    doc: makes numbers
    ports: [{name: out, direction: output, type: /double}]
  t::Sink:
    ports: [{name: in, direction: input, type: /double}, {name: text, direction: input, type: /std/string}]
    properties: [{name: gain, type: /double, default: 2.0, live: true, doc: in metres}]
)";
constexpr std::string_view kNetwork = R"(network: a
tasks:
  source: {component: "t::Source"}
  sink: {component: "t::Sink"}
connections:
  - source.out -> sink.in
)";

/// The model files and libraries of the robot whose models were wanted last.
std::vector<std::string> wanted;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

model::ComponentCatalog test_models(const model::Robot& robot, Diagnostics& diagnostics) {
  wanted = robot.models;
  wanted.insert(wanted.end(), robot.libraries.begin(), robot.libraries.end());
  model::ComponentCatalog catalog;
  // The message quotes a file that could not be read.
  for (const std::string& file : robot.models)
    diagnostics.error("bad", "content of " + file, {(robot.folder / file).string(), 1, 1});
  model::read_components(kComponents, "components.yaml", catalog, diagnostics);
  return catalog;
}

class FileVerbsTest : public RobotFilesTest {
 protected:
  FileVerbsTest() : RobotFilesTest(test_models) {}

  void SetUp() override {
    RobotFilesTest::SetUp();
    fs::create_directories(home_ / "networks");
    write("robot.yaml", "robot: fake\ncontrollers: [networks/*.yaml, ../*.yaml]\n");
    write("networks/a.yaml", kNetwork);
    write("notes.txt", "a secret");
    write("../outside.yaml", "network: outside\n");
    fs::create_symlink(home_ / "notes.txt", home_ / "networks" / "link.yaml");
  }
  /// "error unknown-port 6:5" a problem.
  std::vector<std::string> problems(const std::string& path, const std::string& text) {
    std::vector<std::string> found;
    const Value answer = result("check_file", Value::map({{"path", path}, {"text", text}}), Role::Observe);
    for (const Value& one : answer.find("problems")->as_list())
      found.push_back(one.find("severity")->as_string() + " " + one.find("code")->as_string() + " " +
                      std::to_string(one.find("line")->as_int()) + ":" +
                      std::to_string(one.find("column")->as_int()));
    return found;
  }

  const Value nothing_{type::ValueMap{}};
};

TEST_F(FileVerbsTest, ATextOfABrowserHasOnlyTheRobotsOwnFilesLookedAt) {
  write("own.yaml", "components: {}\n");
  ASSERT_EQ(::mkfifo((home_ / "pipe.yaml").c_str(), 0600), 0);
  const std::string before = "robot: fake\ncontrollers: [networks/*.yaml, ../*.yaml]\n";
  for (const std::string named : {"/etc/passwd", "../outside.yaml", "pipe.yaml", "networks/link.yaml",
                                  "/etc/*", "networks/../../outside.yaml"}) {
    EXPECT_EQ(problems("robot.yaml", before + "models: ['" + named + "']\n"),
              (std::vector<std::string>{"error outside 1:1"}))
        << named;
    EXPECT_EQ(wanted, std::vector<std::string>{}) << named;
  }
  EXPECT_EQ(problems("robot.yaml", before + "libraries: [../../evil]\n").size(), 1U);
  EXPECT_EQ(wanted, std::vector<std::string>{});
  EXPECT_EQ(problems("robot.yaml", before + "models: [own.yaml]\n"), std::vector<std::string>{})
      << "what other files say is not shown";
  EXPECT_EQ(wanted, std::vector<std::string>{"own.yaml"});
}

TEST_F(FileVerbsTest, AMissionOfABrowserNamesOnlyFilesOfTheRobot) {
  write("networks/fetch.yaml", "mission: fetch\nstart: return success\nstates: {}\n");
  write("../secret.yaml", "mission: secret\nstart: return success\nstates: {}\n");
  ASSERT_EQ(::mkfifo((home_ / "pipe.yaml").c_str(), 0600), 0);
  const auto with = [](const std::string& library) {
    return "mission: m\nstart: a\nstates: {a: {library: '" + library + "', on: {success: return success}}}\n";
  };
  write("m.yaml", with("networks/fetch"));
  EXPECT_EQ(problems("m.yaml", with("networks/fetch")), std::vector<std::string>{});
  for (const std::string outside : {"pipe", "networks/link"})
    EXPECT_EQ(problems("m.yaml", with(outside)), std::vector<std::string>{"error missing-library 3:13"})
        << outside;
  for (const std::string path : {"../secret", "/etc/passwd"})
    EXPECT_EQ(problems("m.yaml", with(path)), std::vector<std::string>{"error bad-name 3:23"}) << path;
}

TEST_F(FileVerbsTest, ANetworkOfABrowserIncludesOnlyFilesOfTheRobot) {
  const auto with = [](const std::string& included) {
    return "network: a\ninclude: '" + included + "'\ntasks: {}\n";
  };
  fs::remove(home_ / "networks" / "link.yaml");
  write("networks/a.yaml", with("../base.yaml"));
  write("base.yaml", "network: base\ntasks: {}\n");
  write("../secret.yaml", "network: secret\ntasks: {}\n");
  ASSERT_EQ(::mkfifo((home_ / "pipe.yaml").c_str(), 0600), 0);
  EXPECT_EQ(problems("networks/a.yaml", with("../base.yaml")), std::vector<std::string>{});
  for (const std::string outside : {"../pipe.yaml", "../../secret.yaml", "/etc/passwd", "../gone.yaml"})
    EXPECT_EQ(problems("networks/a.yaml", with(outside)),
              std::vector<std::string>{"error unreadable-file 2:10"})
        << outside;
  write("base.yaml", "password: hidden\ntasks: 3\n");
  EXPECT_EQ(problems("networks/a.yaml", with("../base.yaml")),
            std::vector<std::string>{"error bad-include 1:1"})
      << "what other files say is not shown";
}

TEST_F(FileVerbsTest, ListsTheFilesOfTheRobotAndWhyOthersAreClosed) {
  const Value answer = result("files", nothing_, Role::Observe);
  EXPECT_EQ(*answer.find("folder"), Value(home_.string()));
  std::map<std::string, bool> closed;
  for (const Value& file : answer.find("files")->as_list())
    closed[file.find("path")->as_string()] = !file.find("problem")->as_string().empty();
  EXPECT_EQ(closed, (std::map<std::string, bool>{{"robot.yaml", false},
                                                 {"networks/a.yaml", false},
                                                 {"networks/link.yaml", true},
                                                 {"../outside.yaml", true}}));
}

TEST_F(FileVerbsTest, AFileIsReadCheckedAndSaved) {
  const Value file = result("read_file", Value::map({{"path", "networks/a.yaml"}}));
  EXPECT_EQ(*file.find("text"), Value(kNetwork));
  const std::string edited = std::string(kNetwork) + "# edited\n";
  const Value saved =
      result("save_file",
             Value::map({{"path", "networks/a.yaml"}, {"text", edited}, {"version", *file.find("version")}}));
  EXPECT_EQ(content("networks/a.yaml"), edited);
  EXPECT_EQ(*result("read_file", Value::map({{"path", "networks/a.yaml"}})).find("version"),
            *saved.find("version"));
  EXPECT_EQ(error("save_file", Value::map({{"path", "networks/a.yaml"},
                                           {"text", "network: mine\n"},
                                           {"version", *file.find("version")}})),
            "invalid-state");
  EXPECT_EQ(content("networks/a.yaml"), edited);
}

TEST_F(FileVerbsTest, WhatIsNoTextIsNotEdited) {
  write("networks/a.yaml", "network: \xff\n");
  EXPECT_EQ(error("read_file", Value::map({{"path", "networks/a.yaml"}})), "unsupported");
}

TEST_F(FileVerbsTest, ProblemsHaveTheirPlace) {
  fs::remove(home_ / "networks" / "link.yaml");
  const std::string text(kNetwork);
  EXPECT_EQ(problems("networks/a.yaml", text), std::vector<std::string>{});
  EXPECT_EQ(problems("networks/a.yaml", text + "  - source.out -> sink.text\n"),
            std::vector<std::string>{"error type-mismatch 7:5"});
  EXPECT_EQ(problems("networks/a.yaml", text + "  - source.none -> sink.in\n"),
            std::vector<std::string>{"error unknown-port 7:5"});
  const auto broken = problems("networks/a.yaml", "network: [\n");
  ASSERT_EQ(broken.size(), 1U);
  EXPECT_TRUE(broken[0].starts_with("error ")) << broken[0];
  EXPECT_EQ(content("networks/a.yaml"), text) << "checking writes nothing";
}

TEST_F(FileVerbsTest, ANetworkIsCheckedTogetherWithTheOthers) {
  fs::remove(home_ / "networks" / "link.yaml");
  write("networks/b.yaml", "network: b\ntasks: {}\n");
  const auto found = problems("networks/b.yaml", "network: a\ntasks: {}\n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].starts_with("error ")) << found[0];
  EXPECT_EQ(problems("networks/b.yaml", "network: b\ntasks: {}\n"), std::vector<std::string>{});
}

TEST_F(FileVerbsTest, ARobotFileIsCheckedAlthoughItIsBroken) {
  write("robot.yaml", "robot: fake\ncontrollers: [networks/*.yaml]\nhosts: [\n");
  EXPECT_EQ(result("files", nothing_).find("files")->as_list().size(), 1U);
  const std::string good = "robot: fake\ncontrollers: [networks/a.yaml]\n";
  EXPECT_EQ(problems("robot.yaml", good), std::vector<std::string>{});
  EXPECT_FALSE(problems("robot.yaml", good + "fallback: none\n").empty());
}

TEST_F(FileVerbsTest, NothingElseCanBeNamed) {
  for (const std::string path :
       {"notes.txt", "../outside.yaml", "networks/link.yaml", "networks/../notes.txt", "/etc/passwd", "", ".",
        "networks", "networks/%2e%2e/robot.yaml", "../home/robot.yaml"}) {
    EXPECT_NE(error("read_file", Value::map({{"path", path}})), "") << path;
    EXPECT_NE(error("save_file", Value::map({{"path", path}, {"text", "x"}, {"version", ""}})), "") << path;
  }
  for (const std::string path : {"notes.txt", "/etc/passwd", "", "networks/../notes.txt"})
    EXPECT_EQ(error("check_file", Value::map({{"path", path}, {"text", "x"}})), "not-found") << path;
  EXPECT_EQ(content("notes.txt"), "a secret");
  EXPECT_EQ(content("../outside.yaml"), "network: outside\n");
}

TEST_F(FileVerbsTest, AnObserverMaySaveAndApplyNothing) {
  const Value file = result("read_file", Value::map({{"path", "networks/a.yaml"}}), Role::Observe);
  EXPECT_EQ(
      error("save_file",
            Value::map({{"path", "networks/a.yaml"}, {"text", "x"}, {"version", *file.find("version")}}),
            Role::Observe),
      "permission-denied");
  EXPECT_EQ(error("apply_files", nothing_, Role::Observe), "permission-denied");
  EXPECT_EQ(content("networks/a.yaml"), kNetwork);
  EXPECT_EQ(*result("apply_files", nothing_).find("who"), Value("somebody"));
}

TEST_F(FileVerbsTest, ModelsSayPortsAndProperties) {
  const Value answer = result("models", nothing_, Role::Observe);
  const Value* sink = answer.find("components")->find("t::Sink");
  ASSERT_NE(sink, nullptr);
  EXPECT_EQ(*sink->find("properties")->as_list().at(0).find("doc"), Value("in metres"));
}

TEST_F(FileVerbsTest, FilesCanBeSavedWhileTheRobotIsGone) {
  const Value file = result("read_file", Value::map({{"path", "networks/a.yaml"}}));
  serving_.reset();
  result("save_file",
         Value::map(
             {{"path", "networks/a.yaml"}, {"text", "network: a\n"}, {"version", *file.find("version")}}));
  EXPECT_EQ(content("networks/a.yaml"), "network: a\n");
}

TEST_F(FileVerbsTest, ARobotWithoutFilesHasNothingToEdit) {
  robot_.show(Value::map({{"robot", "fake"}, {"file", Value()}}));
  EXPECT_EQ(error("files", nothing_), "unsupported");
}

struct SlowModels {
  control::Gate asked;
  control::Gate found;
};

/// The models of its robot are found once `found_` is open.
class SlowModelsTest : public RobotFilesTest {
 protected:
  SlowModelsTest() : SlowModelsTest(std::make_shared<SlowModels>()) {}
  void SetUp() override {
    RobotFilesTest::SetUp();
    write("robot.yaml", "robot: fake\n");
  }
  void TearDown() override {
    found_.open();
    RobotFilesTest::TearDown();
  }

  const std::shared_ptr<SlowModels> models_;
  control::Gate& asked_ = models_->asked;
  control::Gate& found_ = models_->found;

 private:
  explicit SlowModelsTest(std::shared_ptr<SlowModels> models)
      : RobotFilesTest([models](const model::Robot&, Diagnostics&) {
          models->asked.open();
          models->found.wait();
          return model::ComponentCatalog();
        }),
        models_(std::move(models)) {}
};

TEST_F(SlowModelsTest, WhoOnlyObservesLeavesCallsToThoseWhoOperate) {
  const auto crowd = Session::create(hub_, verbs_, {Role::Observe, "fake", "somebody"}, [] {});
  for (std::size_t call = 0; call < Verbs::kMostCalls; ++call)
    crowd->receive(R"({"id": 1, "verb": "models"})");
  ASSERT_TRUE(asked_.wait());
  EXPECT_EQ(error("stop", Value(type::ValueMap{}), Role::Operate), "");
}

}  // namespace
}  // namespace segue::web
