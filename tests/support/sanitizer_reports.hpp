// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "dds_suppressions.hpp"

/// Collects the reports of thread sanitizer from the processes that a test starts, which otherwise go to logs
/// that are removed with the test.
namespace segue::testing {

/// Processes started from now on write their reports to that folder.
inline void collect_sanitizer_reports(const std::filesystem::path& folder) {
  const char* set = std::getenv("TSAN_OPTIONS");
  std::string options = set == nullptr ? "" : set;
  options = options.substr(0, options.find(":log_path="));
  options += ":log_path=" + (folder / "sanitizer_report").string();
  const auto suppressions = folder / "sanitizer_suppressions";
  std::ofstream(suppressions) << kDdsSuppressions;
  options += ":suppressions=" + suppressions.string();
  ::setenv("TSAN_OPTIONS", options.c_str(), 1);
}

/// All reports; empty if there is none.
inline std::string sanitizer_reports(const std::filesystem::path& folder) {
  std::string reports;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    if (!file.path().filename().string().starts_with("sanitizer_report.")) continue;
    std::ifstream stream(file.path());
    reports += std::string(std::istreambuf_iterator<char>(stream), {}) + '\n';
  }
  return reports;
}

}  // namespace segue::testing
