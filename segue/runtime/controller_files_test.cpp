// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/runtime/controller_files.hpp>

#include <gmock/gmock.h>
#include <unistd.h>

#include <string>

namespace segue::runtime {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
namespace fs = std::filesystem;

class ControllerFilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "controllers");
    write("robot.yaml", "robot: rover\ncontrollers: [controllers/*.yaml]\n");
    write("controllers/go.yaml", "tasks: {drive: {component: x::Drive}}\n");
    write("controllers/stay.yaml", "tasks: {brake: {component: x::Brake}}\n");
    Diagnostics diagnostics;
    auto started = read_robot_files(folder_ / "robot.yaml", diagnostics);
    ASSERT_TRUE(started && diagnostics.empty()) << to_string(diagnostics);
    started_ = std::move(*started);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    ASSERT_TRUE(write_file(folder_ / name, text));
  }
  [[nodiscard]] ControllerFiles files() const { return {folder_ / "robot.yaml", started_}; }
  [[nodiscard]] std::string problems() const {
    Diagnostics diagnostics;
    (void)files().read(diagnostics);
    return to_string(diagnostics);
  }
  [[nodiscard]] std::vector<FileChange> changes() const {
    return files().changes(started_.controllers.files);
  }

  fs::path folder_ = fs::temp_directory_path() / ("segue_controller_files_" + std::to_string(::getpid()));
  RobotFiles started_;
};

TEST_F(ControllerFilesTest, ChangesAreSeenByContent) {
  EXPECT_THAT(changes(), IsEmpty());
  write("controllers/go.yaml", "tasks: {drive: {component: x::Drive}}\n");
  EXPECT_THAT(changes(), IsEmpty()) << "it was written anew with the same content";
  write("controllers/go.yaml", "tasks: {drive: {component: x::Other}}\n");
  write("controllers/turn.yaml", "tasks: {drive: {component: x::Drive}}\n");
  fs::remove(folder_ / "controllers/stay.yaml");
  EXPECT_THAT(changes(), ElementsAre(FileChange{folder_ / "controllers/go.yaml", FileChange::Kind::Changed},
                                     FileChange{folder_ / "controllers/stay.yaml", FileChange::Kind::Removed},
                                     FileChange{folder_ / "controllers/turn.yaml", FileChange::Kind::Added}));
  Diagnostics diagnostics;
  const auto now = files().read(diagnostics);
  ASSERT_TRUE(now) << to_string(diagnostics);
  EXPECT_EQ(now->controllers.size(), 2U);
  EXPECT_THAT(files().changes(now->files), IsEmpty());
}

TEST_F(ControllerFilesTest, AFileThatChangesWhileTheFilesAreReadIsAnError) {
  Diagnostics diagnostics;
  const auto read = [&](const fs::path& path) {
    auto text = read_file(path);
    if (path.filename() == "stay.yaml")
      write("controllers/go.yaml", "tasks: {drive: {component: x::Another}}\n");
    return text;
  };
  (void)read_robot_files(folder_ / "robot.yaml", diagnostics, read);
  EXPECT_THAT(to_string(diagnostics), HasSubstr("go.yaml' was changed while the files were read"));
  EXPECT_THAT(to_string(diagnostics), HasSubstr("[file-changed]"));
}

TEST_F(ControllerFilesTest, AllProblemsOfAllFilesAreReported) {
  write("controllers/go.yaml", "tasks: 3\n");
  write("controllers/stay.yaml", "tasks: {brake: {}}\n");
  write("robot.yaml", "robot: rover\ncontrollers: [controllers/*.yaml, missing.yaml]\n");
  const std::string found = problems();
  for (const char* part : {"go.yaml:1", "stay.yaml:1", "missing.yaml"})
    EXPECT_THAT(found, HasSubstr(part));
}

TEST_F(ControllerFilesTest, TransitionsAreReadWithTheControllers) {
  write("robot.yaml", "robot: rover\ncontrollers: [controllers/*.yaml]\ntransitions: [transitions/*.yaml]\n");
  fs::create_directories(folder_ / "transitions");
  write("transitions/brake.yaml", "transition: {from: go, to: stay, actions: []}\n");
  Diagnostics diagnostics;
  auto read = read_robot_files(folder_ / "robot.yaml", diagnostics);
  ASSERT_TRUE(read && diagnostics.empty()) << to_string(diagnostics);
  ASSERT_EQ(read->controllers.transitions.size(), 1U);
  EXPECT_EQ(read->controllers.transitions[0].name, "brake");
  started_ = std::move(*read);
  write("transitions/other.yaml", "transition: {name: brake, from: go, to: stay, actions: []}\n");
  EXPECT_THAT(changes(),
              ElementsAre(FileChange{folder_ / "transitions/other.yaml", FileChange::Kind::Added}));
  EXPECT_THAT(problems(), HasSubstr("other.yaml: error: two transitions are named 'brake'"));
}

TEST_F(ControllerFilesTest, AFileWithoutContentIsNoController) {
  for (const char* text : {"", "# saved in part\n"}) {
    write("controllers/go.yaml", text);
    EXPECT_THAT(problems(), HasSubstr("go.yaml: error: this file is empty"));
  }
}

TEST_F(ControllerFilesTest, WhatNeedsARestartIsSaid) {
  write("robot.yaml", "robot: rover\ncontrollers: [controllers/*.yaml]\npolicies: {watch: 2s}\n");
  EXPECT_THAT(problems(),
              HasSubstr("warning: 'policies' has changed, which takes effect when the robot is started"));
  write("robot.yaml", "robot: crane\ncontrollers: [controllers/*.yaml]\n");
  EXPECT_THAT(problems(), HasSubstr("error: the robot is called 'crane' now, but 'rover' runs"));
}

}  // namespace
}  // namespace segue::runtime
