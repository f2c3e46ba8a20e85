// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/base/shared_mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/model/port_pattern.hpp>

#include <algorithm>
#include <memory>
#include <regex>
#include <unordered_map>

namespace segue::model {
namespace {

constexpr std::size_t kLongestPattern = 256;
constexpr std::size_t kLongestName = 255;
/// Upper bound of the number of states of the automaton, hence of memory, stack and time of a match.
constexpr std::size_t kLargestExpansion = 4096;

using Compiled = Result<std::regex>;

/// Upper bound of the length of the expression with all counted repetitions expanded.
std::size_t expansion(const std::string& pattern) {
  std::size_t product = pattern.size();
  std::size_t number = 0;
  bool inside = false;
  for (const char c : pattern) {
    if (c == '{') inside = true;
    if (inside && c >= '0' && c <= '9') {
      number = std::min(number * 10 + static_cast<std::size_t>(c - '0'), kLargestExpansion);
      continue;
    }
    product = std::min(product * std::max<std::size_t>(number, 1), kLargestExpansion + 1);
    number = 0;
    if (c == '}') inside = false;
  }
  return product;
}

Compiled compile(const std::string& pattern) {
  auto refuse = [&](const std::string& why) {
    return fail(ErrorCode::InvalidArgument, "the port pattern " + quote(pattern) + " " + why);
  };
  if (pattern.size() > kLongestPattern) return refuse("is longer than 256 characters");
  if (expansion(pattern) > kLargestExpansion) return refuse("repeats too often; use '*' or '+'");
  try {
    // The breadth-first matcher of libstdc++: linear in the name, where backtracking would be exponential.
    return std::regex(pattern, std::regex::ECMAScript | std::regex_constants::__polynomial);
  } catch (const std::regex_error& error) {
    return refuse(std::string("is not a regular expression: ") + error.what());
  }
}

/// Cache of compiled expressions. Models are few and live long, so entries are never removed.
const Compiled& compiled(const std::string& pattern) {
  static SharedMutex mutex;
  static std::unordered_map<std::string, std::unique_ptr<const Compiled>> cache;
  {
    const ReadLock lock(mutex);
    if (auto found = cache.find(pattern); found != cache.end()) return *found->second;
  }
  auto fresh = std::make_unique<const Compiled>(compile(pattern));
  const WriteLock lock(mutex);
  return *cache.try_emplace(pattern, std::move(fresh)).first->second;
}

}  // namespace

Result<void> check_port_pattern(const std::string& pattern) {
  const Compiled& result = compiled(pattern);
  if (!result) return result.error();
  return {};
}

bool matches_port_pattern(const std::string& pattern, std::string_view name) {
  if (name.size() > kLongestName) return false;
  const Compiled& result = compiled(pattern);
  return result.has_value() && std::regex_match(name.begin(), name.end(), *result);
}

std::string whole_match_pattern(std::string_view searched) {
  if (searched == ".*" || searched.empty()) return ".*";
  if (searched.find('|') != std::string_view::npos) return ".*(?:" + std::string(searched) + ").*";
  const bool anchored = searched.starts_with('^');
  const bool escaped = searched.size() > 1 && searched[searched.size() - 2] == '\\';
  const bool closed = searched.ends_with('$') && !escaped;
  if (anchored) searched.remove_prefix(1);
  if (closed) searched.remove_suffix(1);
  return (anchored ? "" : ".*") + std::string(searched) + (closed ? "" : ".*");
}

}  // namespace segue::model
