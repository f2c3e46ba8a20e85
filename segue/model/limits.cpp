// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/file_parts.hpp>

#include <limits>
#include <utility>

namespace segue::model::detail {

using type::Value;
using type::ValueMap;

namespace {

/// A lower limit is refused as a mistake: the process would end before its first task.
constexpr std::uint64_t kLeastMemory = std::uint64_t{16} << 20;
constexpr std::uint64_t kLeastFiles = 64;
constexpr std::uint64_t kMostFiles = std::numeric_limits<std::int32_t>::max();

}  // namespace

std::optional<std::string> problem_of(const ResourceLimits& limits) {
  if (limits.memory && *limits.memory < kLeastMemory) {
    return "a process cannot live in " + format_size(*limits.memory) + " of memory; give it " +
           format_size(kLeastMemory) + " or more";
  }
  if (limits.open_files && (*limits.open_files < kLeastFiles || *limits.open_files > kMostFiles)) {
    return "open_files must be at least " + std::to_string(kLeastFiles) + ", got " +
           std::to_string(*limits.open_files);
  }
  const bool whole = !limits.cpu_time || *limits.cpu_time % std::chrono::seconds(1) == Duration::zero();
  if (limits.cpu_time && (!whole || *limits.cpu_time <= Duration::zero())) {
    return "cpu_time must be whole seconds, at least one, got " + format_duration(*limits.cpu_time);
  }
  return std::nullopt;
}

ResourceLimits read_limits(const Value& value, const std::string& what, const Source& source) {
  Fields fields(value, what, source);
  ResourceLimits limits;
  limits.memory = fields.size("memory", "bad-limit");
  const auto files = fields.integer("open_files", static_cast<std::int64_t>(kLeastFiles),
                                    static_cast<std::int64_t>(kMostFiles), "bad-limit");
  if (files) limits.open_files = static_cast<std::uint64_t>(*files);
  limits.cpu_time = fields.duration("cpu_time");
  limits.core = fields.size("core", "bad-limit");
  fields.finish();
  if (auto problem = problem_of(limits)) {
    source.error("bad-limit", fields.what() + ": " + *problem, value);
    return {};
  }
  return limits;
}

Value write_limits(const ResourceLimits& limits) {
  ValueMap map;
  if (limits.memory) map.append("memory", format_size(*limits.memory));
  if (limits.open_files) map.append("open_files", *limits.open_files);
  if (limits.cpu_time) map.append("cpu_time", format_duration(*limits.cpu_time));
  if (limits.core) map.append("core", format_size(*limits.core));
  return map;
}

}  // namespace segue::model::detail
