// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/type/yaml.hpp>
#include <support/expected_diagnostics.hpp>
#include <support/paths.hpp>

#include <gtest/gtest.h>

#include <filesystem>

/// Runs tests/cases/mission/check/*.yaml; README.md there describes the format. A new case needs no C++.
namespace segue::mission {
namespace {

using type::Value;

const std::filesystem::path kCases = segue::paths::in_sources("/tests/cases/mission");

Diagnostics examine(const std::string& text) {
  Diagnostics found;
  if (const auto mission = read_mission(text, "", found)) found.append(validate(*mission));
  found.sort();
  return found;
}

class MissionCheckCase : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(MissionCheckCase, ReportsExactlyWhatItExpects) {
  const auto root = type::load_yaml(GetParam());
  ASSERT_TRUE(root) << to_string(root.error());
  const Value* mission = root->find("mission");
  ASSERT_TRUE(mission != nullptr && mission->is_string());
  testing::expect_diagnostics(examine(mission->as_string()), root->find("expect"));
}

INSTANTIATE_TEST_SUITE_P(Files, MissionCheckCase, ::testing::ValuesIn(glob_files(kCases / "check/*.yaml")),
                         [](const auto& one) { return one.param.stem().string(); });

}  // namespace
}  // namespace segue::mission
