// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue {

/// 'text' in single quotes for a message: control characters are escaped, long text is shortened.
std::string quote(std::string_view text);

/// The text as the content or a quoted attribute of an XML or HTML element. Control characters other than
/// line feeds become spaces.
std::string escape_markup(std::string_view text);

/// ", did you mean 'x'?" with the most similar of the first thousand `candidates`, or "" if none is similar.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

/// For messages about an unknown name: did_you_mean(), or, where no candidate is similar, the first twelve of
/// them: "; it has a, b and c" for `has` "it has". "" if there are no candidates.
std::string did_you_mean_or_list(std::string_view word, std::span<const std::string> candidates,
                                 std::string_view has);

/// "a, b and c"
std::string listed(std::span<const std::string> items);

/// "1 action", "3 actions": the plural is formed with an s.
std::string counted(std::size_t count, std::string_view noun);

/// The parts between the separators, empty ones too; at least one. They refer to `text`.
std::vector<std::string_view> split(std::string_view text, char separator);

/// "100ms", "1.5 s", "20us", "3min"; a number without a unit is refused.
Result<Duration> parse_duration(std::string_view text);

/// The shortest exact form with a unit: "100ms", "1.5s".
std::string format_duration(Duration duration);

/// "512MB" (millions), "64MiB" (2^20), "10 kB", "100B"; the only number accepted without a unit is 0.
Result<std::uint64_t> parse_size(std::string_view text);

/// The shortest exact form with a unit: "512MB", "64MiB", "4097B".
std::string format_size(std::uint64_t bytes);

/// Whether `text` is an identifier and cannot be a path: at most 255 bytes; a letter, digit or '_' first,
/// then letters, digits, '_', '-', '.' or ':' (as in "demo::Filter").
bool is_identifier(std::string_view text);
/// The rule of is_identifier(), for messages.
inline constexpr std::string_view kIdentifierRule =
    "a letter, a digit or '_' first, then letters, digits, '_', '-', '.' and ':' only, at most 255";

/// Whether `text` matches a shell-style pattern with '*' and '?'.
bool matches_glob(std::string_view pattern, std::string_view text);

}  // namespace segue
