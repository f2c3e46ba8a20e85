// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <support/paths.hpp>

#include <cstdlib>
#include <filesystem>
#include <string>

/// Data that is not part of Segue: experiments of papers, competition plans. It is found beside the source
/// tree or in SEGUE_SHARED_DATA; tests that need it are skipped if it is absent.
namespace segue {

inline std::filesystem::path shared_data(const std::string& part) {
  const char* given = std::getenv("SEGUE_SHARED_DATA");
  return std::filesystem::path(given != nullptr ? given : segue::paths::in_sources("/../shared/data")) / part;
}

}  // namespace segue
