// SPDX-License-Identifier: Apache-2.0
#include "proc_files.hpp"

#include <algorithm>
#include <charconv>

namespace computer {
namespace {

/// Takes the next line off `text`, without its end; nothing where there is no whole line.
std::optional<std::string_view> take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  return line;
}

/// Takes the next number off `line`, and the blanks before it.
std::optional<std::uint64_t> take_number(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  std::uint64_t number = 0;
  const auto [rest, problem] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (problem != std::errc{}) return std::nullopt;
  line.remove_prefix(static_cast<std::size_t>(rest - line.data()));
  return number;
}

/// "MemTotal:       24058256 kB", in bytes; nothing where the line is about something else.
std::optional<std::uint64_t> bytes_of(std::string_view line, std::string_view name) {
  if (!line.starts_with(name)) return std::nullopt;
  line.remove_prefix(name.size());
  const auto kibibytes = take_number(line);
  return kibibytes ? std::optional(*kibibytes * 1024) : std::nullopt;
}

}  // namespace

std::optional<ProcessorTicks> processor_ticks(std::string_view stat) {
  constexpr std::size_t kIdle = 3;  // user, nice, system, idle, iowait ...
  constexpr std::size_t kInputOutput = 4;
  constexpr std::size_t kCounted = 8;  // what guests took, after these, is in the first two
  auto line = take_line(stat);
  if (!line || !line->starts_with("cpu ")) return std::nullopt;
  line->remove_prefix(3);
  ProcessorTicks ticks;
  for (std::size_t i = 0; i < kCounted; ++i) {
    const auto number = take_number(*line);
    if (!number) return std::nullopt;
    ticks.all += *number;
    if (i == kIdle || i == kInputOutput) ticks.idle += *number;
  }
  for (line = take_line(stat); line && line->starts_with("cpu"); line = take_line(stat))
    ++ticks.processors;
  return line && ticks.processors > 0 ? std::optional(ticks) : std::nullopt;
}

std::optional<MemoryBytes> memory_bytes(std::string_view meminfo) {
  std::optional<std::uint64_t> total;
  std::optional<std::uint64_t> available;
  while (const auto line = take_line(meminfo)) {
    if (!total) total = bytes_of(*line, "MemTotal:");
    if (!available) available = bytes_of(*line, "MemAvailable:");
  }
  return total && available ? std::optional(MemoryBytes{*total, *available}) : std::nullopt;
}

}  // namespace computer
