// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

/// Data that is not part of Segue: experiments of papers, competition plans. It lies beside the source tree,
/// or where SEGUE_SHARED_DATA says; tests that need it skip where it is absent.
namespace segue {

inline std::filesystem::path shared_data(const std::string& part) {
  const char* given = std::getenv("SEGUE_SHARED_DATA");
  return std::filesystem::path(given != nullptr ? given : SEGUE_SOURCE_DIR "/../shared/data") / part;
}

}  // namespace segue
