// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_script/script_check.hpp>
#include <segue/rafcon/rafcon.hpp>

#include <support/paths.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace segue::mission {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class CompiledScripts : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "segue-compile-XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// The problems of the mission, without the name of the folder.
  std::string problems_of(const std::string& text, const ScriptOptions& options = {}) {
    EXPECT_TRUE(write_file(folder_ / "m.yaml", text));
    Diagnostics diagnostics;
    const auto mission = load_mission(folder_ / "m.yaml", {}, diagnostics);
    EXPECT_TRUE(mission) << to_string(diagnostics);
    if (!mission) return {};
    ScriptCompiler(options).check(*mission, diagnostics);
    std::string said = to_string(diagnostics);
    for (auto at = said.find(folder_.string()); at != std::string::npos; at = said.find(folder_.string()))
      said.erase(at, folder_.string().size() + 1);
    return said;
  }
  std::filesystem::path folder_;
};

TEST_F(CompiledScripts, AreFoundWhereTheyAreNoPythonWithTheirFileLineAndColumn) {
  EXPECT_TRUE(write_file(folder_ / "a.py", "def execute(self, inputs, outputs, gvm):\n    return = 0\n"));
  EXPECT_THAT(problems_of("mission: m\nactions: {a: {run: {python: a.py}}}\naction: a\n"),
              AllOf(StartsWith("a.py:2:12: error: action 'a': SyntaxError: invalid syntax"),
                    EndsWith("[bad-script]\n")));
}

TEST_F(CompiledScripts, AreFoundInABlockOfTheMissionFile) {
  EXPECT_THAT(
      problems_of(
          "mission: m\nactions:\n  a:\n    run:\n      python:\n        text: |\n\n"
          "          def execute(self, inputs, outputs, gvm):\n              return = 0\naction: a\n"),
      StartsWith("m.yaml:9:22: error: action 'a': line 3 of its script: SyntaxError: invalid syntax"));
}

TEST_F(CompiledScripts, AreFoundInAQuotedText) {
  EXPECT_THAT(
      problems_of("mission: m\nactions: {a: {run: {python: {text: \"x = 1\\ny = = 2\"}}}}\naction: a\n"),
      StartsWith("m.yaml:2:36: error: action 'a': line 2 of its script: SyntaxError: invalid syntax"));
}

TEST_F(CompiledScripts, OfDataOfTheWorldAreCompiledToo) {
  EXPECT_THAT(problems_of("mission: m\nworld_data:\n  tally: {initial: 0, python: {text: \"def add(:\"}, "
                          "effects: {'+done': add}}\n"
                          "actions: {a: {effects: [+done], run: {simulated: {}}}}\naction: a\n"),
              HasSubstr("error: the world data 'tally': line 1 of its script: SyntaxError"));
}

TEST_F(CompiledScripts, OfARafconMachineAreFoundInItsFolder) {
  const auto machine = folder_ / "machine";
  std::filesystem::copy(segue::paths::in_sources("/tests/rafcon/live_objects"), machine,
                        std::filesystem::copy_options::recursive);
  EXPECT_TRUE(write_file(machine / "uses_USESAA/script.py", "def execute(self):\n  x = (1\n"));
  Diagnostics diagnostics;
  const auto imported = import_rafcon(machine, {}, diagnostics);
  ASSERT_TRUE(imported) << to_string(diagnostics);
  ScriptCompiler().check(imported->mission, diagnostics);
  EXPECT_THAT(to_string(diagnostics), HasSubstr((machine / "uses_USESAA/script.py").string() + ":2:"));
}

TEST_F(CompiledScripts, AreNotExecuted) {
  EXPECT_EQ(problems_of(
                "mission: m\nactions: {a: {run: {python: {text: \"import os; os._exit(3)\"}}}}\naction: a\n"),
            "");
}

TEST_F(CompiledScripts, ThatCannotBeReadAreNoNews) {
  EXPECT_THAT(problems_of("mission: m\nactions: {a: {run: {python: gone.py}}}\naction: a\n"),
              AllOf(HasSubstr("[missing-script]"), Not(HasSubstr("bad-script"))));
}

TEST_F(CompiledScripts, AreAWarningWithoutAnInterpreter) {
  ScriptOptions options;
  options.python = "no-such-python";
  EXPECT_THAT(
      problems_of("mission: m\nactions: {a: {run: {python: {text: \"x\"}}}}\naction: a\n", options),
      HasSubstr("warning: scripts were not compiled: cannot find the Python interpreter 'no-such-python'"));
}

}  // namespace
}  // namespace segue::mission
