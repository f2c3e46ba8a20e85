// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/base/recent_log.hpp>
#include <segue/base/utf8.hpp>

#include <algorithm>
#include <deque>
#include <functional>
#include <map>

namespace segue {

namespace {

constexpr std::size_t kKeptLines = 100;
constexpr std::size_t kKeptSources = 256;
constexpr std::size_t kLongestLine = 2000;  ///< bytes

struct Kept {
  Mutex mutex;  ///< guards the members below
  std::uint64_t last SEGUE_GUARDED_BY(mutex) = 0;
  /// By source; none is empty.
  std::map<std::string, std::deque<LogLine>, std::less<>> lines SEGUE_GUARDED_BY(mutex);
};

/// Never destroyed: threads may log while the process exits.
Kept& kept() {
  static auto* instance = new Kept;
  return *instance;
}

}  // namespace

std::vector<LogLine> recent_log(std::string_view source) {
  const Lock lock(kept().mutex);
  const auto found = kept().lines.find(source);
  if (found == kept().lines.end()) return {};
  return {found->second.begin(), found->second.end()};
}

void detail::keep_line(LogLevel level, std::string_view source, std::string_view message) {
  const Lock lock(kept().mutex);
  auto& lines = kept().lines;
  auto found = lines.find(source);
  if (found == lines.end()) {
    if (lines.size() == kKeptSources) {
      lines.erase(std::min_element(lines.begin(), lines.end(), [](const auto& a, const auto& b) {
        return a.second.back().number < b.second.back().number;
      }));
    }
    found = lines.emplace(source, std::deque<LogLine>()).first;
  }
  if (found->second.size() == kKeptLines) found->second.pop_front();
  found->second.push_back({++kept().last, std::chrono::system_clock::now(), level,
                           std::string(beginning_of(message, kLongestLine))});
}

}  // namespace segue
