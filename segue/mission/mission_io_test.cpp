// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/mission/mission_io.hpp>

#include <support/paths.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>

namespace segue::mission {
namespace {

using ::testing::HasSubstr;

/// One of everything that a mission file can hold.
const std::filesystem::path kEverything = segue::paths::in_sources("/tests/cases/mission/everything.yaml");

TEST(MissionFile, IsWrittenBackEqual) {
  Diagnostics loading;
  const auto mission = load_mission(kEverything, {}, loading);
  ASSERT_TRUE(mission) << to_string(loading);
  EXPECT_THAT(to_string(loading),
              HasSubstr("everything.yaml:39:9: warning: action 'plan': there is no script "
                        "'plan.py' [missing-script]"));
  Diagnostics diagnostics;
  const auto copy = read_mission(write_mission(*mission), "copy.yaml", diagnostics);
  ASSERT_TRUE(copy) << to_string(diagnostics);
  EXPECT_EQ(*copy, *mission);
  EXPECT_TRUE(diagnostics.empty()) << to_string(diagnostics);
}

TEST(MissionFile, KeepsThePlaceOfEveryPart) {
  Diagnostics diagnostics;
  const auto mission = read_mission(
      "mission: m\nstart: a\nstates:\n  a:\n    on: {success: return success}\n", "m.yaml", diagnostics);
  ASSERT_TRUE(mission);
  EXPECT_EQ(to_string(mission->states[1].transitions[0].where), "m.yaml:5:19");
}

class LibraryFiles : public ::testing::Test {
 protected:
  LibraryFiles() {
    folder_ = std::filesystem::temp_directory_path() /
              ("segue_mission_" + std::to_string(::getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_ / "tools");
  }
  ~LibraryFiles() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, std::string_view text) {
    ASSERT_TRUE(write_file(folder_ / name, text));
  }

  std::filesystem::path folder_;
  Diagnostics diagnostics_;
};

TEST_F(LibraryFiles, AreFoundBesideTheFileThatNamesThem) {
  write("main.yaml",
        "mission: main\nstart: a\nstates: {a: {library: tools/outer, on: {success: return success}}}\n");
  write("tools/outer.yaml",
        "mission: outer\nstart: a\nstates: {a: {library: inner, on: {success: return success}}}\n");
  write("tools/inner.yaml", "mission: inner\nactions: {rest: }\naction: rest\n");
  const auto mission = load_mission(folder_ / "main.yaml", {}, diagnostics_);
  ASSERT_TRUE(mission) << to_string(diagnostics_);
  EXPECT_EQ(mission->libraries.size(), 2U);
  EXPECT_EQ(mission->states.size(), 5U);
}

TEST_F(LibraryFiles, AreFoundInTheFoldersGiven) {
  write("main.yaml", "mission: main\nlibrary: rest\n");
  write("tools/rest.yaml", "mission: rest\nactions: {rest: }\n");
  EXPECT_FALSE(load_mission(folder_ / "main.yaml", {}, diagnostics_));
  EXPECT_THAT(to_string(diagnostics_), HasSubstr("missing-library"));
  Diagnostics none;
  EXPECT_TRUE(load_mission(folder_ / "main.yaml", {folder_ / "tools"}, none)) << to_string(none);
}

TEST_F(LibraryFiles, ThatUseEachOtherInACircleAreRefused) {
  write("main.yaml", "mission: main\nlibrary: tools/a\n");
  write("tools/a.yaml", "mission: a\nlibrary: b\n");
  write("tools/b.yaml", "mission: b\nlibrary: a\n");
  EXPECT_FALSE(load_mission(folder_ / "main.yaml", {folder_ / "tools"}, diagnostics_));
  EXPECT_THAT(to_string(diagnostics_), HasSubstr("library-recursion"));
}

TEST_F(LibraryFiles, KeepTheirActionsApart) {
  write("main.yaml",
        "mission: main\nactions: {rest: {pure: true}}\nstart: rest\n"
        "states: {rest: {on: {success: other}}, other: {library: tools/nap, on: {success: return "
        "success}}}\n");
  write("tools/nap.yaml", "mission: nap\nactions: {rest: {pure: false}}\naction: rest\n");
  const auto mission = load_mission(folder_ / "main.yaml", {}, diagnostics_);
  ASSERT_TRUE(mission) << to_string(diagnostics_);
  EXPECT_EQ(mission->states.back().action.str(), "tools:nap:rest");
}

TEST_F(LibraryFiles, KeepScriptsOfOneNameInTwoFoldersApart) {
  const std::string actions = "actions: {rest: {run: {python: rest.py}}}\n";
  write("main.yaml", "mission: main\n" + actions +
                         "start: rest\nstates:\n  rest: {on: {success: same}}\n"
                         "  same: {library: same, on: {success: other}}\n"
                         "  other: {library: tools/nap, on: {success: return success}}\n");
  write("same.yaml", "mission: same\n" + actions + "action: rest\n");
  write("tools/nap.yaml", "mission: nap\n" + actions + "action: rest\n");
  const auto mission = load_mission(folder_ / "main.yaml", {}, diagnostics_);
  ASSERT_TRUE(mission) << to_string(diagnostics_);
  EXPECT_EQ(mission->actions.size(), 2U);
  EXPECT_EQ(mission->states.back().action.str(), "tools:nap:rest");
}

}  // namespace
}  // namespace segue::mission
