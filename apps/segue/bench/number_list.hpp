// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/text.hpp>

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

namespace segue::cli {

/// "1,2.5,30": nothing if one of the parts is no number.
template <class Number>
std::optional<std::vector<Number>> parse_number_list(std::string_view text) {
  std::vector<Number> numbers;
  for (const std::string_view part : split(text, ',')) {
    const char* const end = part.data() + part.size();
    const auto [rest, status] = std::from_chars(part.data(), end, numbers.emplace_back());
    if (status != std::errc{} || rest != end) return std::nullopt;
  }
  return numbers;
}

}  // namespace segue::cli
