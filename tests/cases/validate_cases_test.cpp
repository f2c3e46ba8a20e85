// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/model/files.hpp>
#include <segue/model/hints.hpp>
#include <segue/model/validate.hpp>
#include <segue/solve/check_transitions.hpp>
#include <segue/type/yaml.hpp>
#include <support/expected_diagnostics.hpp>
#include <support/paths.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <set>

/// Runs tests/cases/validate/*.yaml; README.md there describes the format. A new case needs no C++.
namespace segue::model {
namespace {

using type::Value;

/// The documents of a case by file name.
constexpr std::array<std::string_view, 4> kDocuments = {"components", "network", "robot", "transition"};

struct Case {
  Value root;
  std::string text(std::string_view key) const {
    const Value* value = root.find(key);
    return value == nullptr ? std::string{} : value->as_string();
  }
};

/// All diagnostics of reading and validating the documents.
Diagnostics examine(const Case& test) {
  Diagnostics found;
  ComponentCatalog catalog;
  if (test.root.find("components") != nullptr) {
    read_components(test.text("components"), "components", catalog, found);
    resolve_inheritance(catalog, found);
  }
  std::vector<Network> networks;
  if (test.root.find("network") != nullptr) {
    const auto network = read_network(test.text("network"), "network", found);
    const Depth depth = test.text("depth") == "structure" ? Depth::Structure : Depth::Full;
    if (network) {
      found.append(validate(*network, catalog, depth));
      if (test.root.find("hints") != nullptr) found.append(hints(*network, catalog));
      networks.push_back(*network);
    }
  }
  if (test.root.find("robot") != nullptr) {
    const auto robot = read_robot(test.text("robot"), "robot", found);
    if (robot) found.append(validate(*robot, networks));
  }
  if (test.root.find("transition") != nullptr) {
    const auto transition = read_transition(test.text("transition"), "transition", found);
    if (transition && !found.has_errors() && !networks.empty())
      found.append(solve::check_transitions({*transition}, networks, catalog, Depth::Full));
  }
  found.sort();
  return found;
}

class ValidateCase : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(ValidateCase, ReportsExactlyWhatItExpects) {
  const auto root = type::load_yaml(GetParam());
  ASSERT_TRUE(root) << to_string(root.error());
  const Case test{*root};
  static const std::set<std::string> kOther = {"case", "depth", "expect", "hints"};
  for (const auto& [key, part] : test.root.as_map()) {
    const bool known = kOther.contains(key) || std::ranges::find(kDocuments, key) != kDocuments.end();
    ASSERT_TRUE(known) << "no case has a part " << key;
  }
  testing::expect_diagnostics(examine(test), test.root.find("expect"), "network");
}

std::vector<std::filesystem::path> case_files() {
  return glob_files(std::filesystem::path(segue::paths::kSourceFolder) / "tests/cases/validate/*.yaml");
}

INSTANTIATE_TEST_SUITE_P(Files, ValidateCase, ::testing::ValuesIn(case_files()),
                         [](const auto& one) { return one.param.stem().string(); });

TEST(ValidateCases, AreThere) {
  EXPECT_GE(case_files().size(), 40U);
}

}  // namespace
}  // namespace segue::model
