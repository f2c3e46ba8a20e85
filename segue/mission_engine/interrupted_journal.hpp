// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/fnv1a.hpp>
#include <segue/mission_engine/run_journal_file.hpp>

#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace segue::mission {

/// For tests: what was in the file of a run when it had that many bytes, as a run leaves it that is killed
/// then. Not the same as the file with its end cut off, whose second line says that something is missing.
inline std::string interrupted_journal(std::string_view journal, std::size_t bytes) {
  const auto hexadecimal = [](std::uint64_t number) {
    char text[17];
    std::snprintf(text, sizeof text, "%016" PRIx64, number);
    return std::string(text);
  };
  const auto number_at = [&](std::size_t place) {
    return std::strtoull(std::string(journal.substr(place, 16)).c_str(), nullptr, 16);
  };
  const std::size_t first_end = journal.find('\n');
  const std::size_t second_end = journal.find('\n', first_end + 1);
  if (first_end == std::string_view::npos || second_end == std::string_view::npos || bytes <= second_end)
    return std::string(journal.substr(0, bytes));
  const std::string_view entries = journal.substr(second_end + 1, bytes - second_end - 1);
  std::uint64_t synced = 0;
  std::uint64_t number = 0;
  for (std::size_t at = 0, end = entries.find('\n'); end != std::string_view::npos;
       at = end + 1, end = entries.find('\n', at)) {
    const std::string_view entry = entries.substr(at, end - at);
    const auto has = [&](std::string_view field) { return entry.find(field) != std::string_view::npos; };
    ++number;
    if (has("\"irreversible\":true") || has("\"progressed\":") || has("\"finished\":")) synced = number;
  }
  std::string second = "{\"synced\":\"" + hexadecimal(synced) + '"';
  second += ",\"checksum\":\"" + hexadecimal(fnv1a(second, number_at(first_end - 18))) + "\"}\n";
  return std::string(journal.substr(0, first_end + 1)) + second + std::string(entries);
}

}  // namespace segue::mission
