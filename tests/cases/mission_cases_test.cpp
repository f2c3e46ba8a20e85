// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/mission/files.hpp>
#include <segue/type/yaml.hpp>

#include <gtest/gtest.h>

#include <filesystem>

/// Runs tests/cases/mission/check/*.yaml; README.md there tells the format. A new case needs no C++.
namespace segue::mission {
namespace {

using type::Value;

const std::filesystem::path kCases = SEGUE_SOURCE_DIR "/tests/cases/mission";

Diagnostics examine(const std::string& text) {
  Diagnostics found;
  if (const auto mission = read_mission(text, "", found)) found.append(validate(*mission));
  found.sort();
  return found;
}

/// "6:5 error unknown-state"
std::string head(const Diagnostic& diagnostic) {
  return std::to_string(diagnostic.where.line) + ":" + std::to_string(diagnostic.where.column) + " " +
         std::string(to_string(diagnostic.severity)) + " " + diagnostic.code;
}

/// What follows the first ": " must be part of the message.
bool fits(const Diagnostic& diagnostic, const std::string& expected) {
  const auto colon = expected.find(": ");
  if (expected.substr(0, colon) != head(diagnostic)) return false;
  return colon == std::string::npos ||
         diagnostic.message.find(expected.substr(colon + 2)) != std::string::npos;
}

std::string all(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& item : diagnostics.items())
    text += "  - \"" + head(item) + ": " + item.message + "\"\n";
  return text;
}

class MissionCheckCase : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(MissionCheckCase, reportsExactlyWhatItExpects) {
  const auto root = type::load_yaml(GetParam());
  ASSERT_TRUE(root) << to_string(root.error());
  const Value* mission = root->find("mission");
  const Value* expect = root->find("expect");
  ASSERT_TRUE(mission != nullptr && mission->is_string() && expect != nullptr && expect->is_list());
  const Diagnostics found = examine(mission->as_string());
  ASSERT_EQ(found.items().size(), expect->as_list().size()) << "found:\n" << all(found);
  for (std::size_t i = 0; i < found.items().size(); ++i) {
    const std::string& expected = expect->as_list()[i].as_string();
    EXPECT_TRUE(fits(found.items()[i], expected)) << "expected: " << expected << "\nfound:\n" << all(found);
  }
}

INSTANTIATE_TEST_SUITE_P(Files, MissionCheckCase, ::testing::ValuesIn(glob_files(kCases / "check/*.yaml")),
                         [](const auto& one) { return one.param.stem().string(); });

}  // namespace
}  // namespace segue::mission
