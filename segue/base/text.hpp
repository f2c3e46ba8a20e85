// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue {

/// 'text' in single quotes, control characters escaped and long text shortened: fit for a message.
std::string quote(std::string_view text);

/// ", did you mean 'x'?" for the nearest of `candidates`, or "" if none is near.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

/// "a, b and c"
std::string listed(std::span<const std::string> items);

/// "100ms", "1.5 s", "20us", "3min"; a bare number is refused (units belong to the text).
Result<Duration> parse_duration(std::string_view text);

/// The shortest exact form with a unit: "100ms", "1.5s".
std::string format_duration(Duration duration);

/// "512MB" (millions), "64MiB" (2^20), "10 kB", "100B"; of bare numbers only 0 (units belong to the text).
Result<std::uint64_t> parse_size(std::string_view text);

/// The shortest exact form with a unit: "512MB", "64MiB", "4097B".
std::string format_size(std::uint64_t bytes);

/// A letter or '_' first, then letters, digits, '_', '-', '.' or ':' (as in "demo::Filter"): an identifier,
/// never a path. At most 255 bytes.
bool is_identifier(std::string_view text);

/// Shell-style pattern with '*' and '?'.
bool matches_glob(std::string_view pattern, std::string_view text);

}  // namespace segue
