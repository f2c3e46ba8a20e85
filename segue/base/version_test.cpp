// SPDX-License-Identifier: Apache-2.0
#include <segue/version.hpp>

#include <gtest/gtest.h>
#include <support/paths.hpp>

#include <fstream>
#include <regex>
#include <sstream>
#include <string>

namespace segue {
namespace {

TEST(VersionTest, TheLoadedLibraryIsTheOneCompiledAgainst) {
  EXPECT_EQ(version(), kCompiledVersion);
}

TEST(VersionTest, VersionsAreOrderedByMajorThenMinorThenPatch) {
  EXPECT_LT((Version{0, 1, 9}), (Version{0, 2, 0}));
  EXPECT_LT((Version{0, 9, 9}), (Version{1, 0, 0}));
}

TEST(VersionTest, TheNewestClosedSectionOfTheChangelogIsThisVersion) {
  std::ifstream file(std::string(paths::kSourceFolder) + "/CHANGELOG.md");
  const std::string text = (std::ostringstream() << file.rdbuf()).str();
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text, found, std::regex(R"(\n## (\d+)\.(\d+)\.(\d+) - )")));
  const Version newest{std::stoi(found[1]), std::stoi(found[2]), std::stoi(found[3])};
  EXPECT_EQ(newest, kCompiledVersion);
}

}  // namespace
}  // namespace segue
