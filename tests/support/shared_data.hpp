// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <support/paths.hpp>

#include <cstdlib>
#include <filesystem>
#include <string>

/// Data that is not part of Segue: experiments of papers, competition plans. It is found beside the source
/// tree or in SEGUE_SHARED_DATA. Cases that need it are in a suite whose name ends in SharedData (see
/// segue_test) and begin with:
///
///     if (const auto missing = missing_shared_data("pddl"); !missing.empty()) GTEST_SKIP() << missing;
namespace segue {

/// The folder or file `part` of the data, or the folder of all.
inline std::filesystem::path shared_data(const std::string& part = {}) {
  const char* given = std::getenv("SEGUE_SHARED_DATA");
  const std::filesystem::path all = given != nullptr ? given : segue::paths::in_sources("/../shared/data");
  return part.empty() ? all : all / part;
}

/// Names what is missing where the part is absent; otherwise empty.
inline std::string missing_shared_data(const std::string& part = {}) {
  const std::filesystem::path place = shared_data(part);
  if (std::filesystem::exists(place)) return {};
  return place.string() +
         " is missing (SEGUE_SHARED_DATA names the folder of data that is not part of Segue)";
}

}  // namespace segue
