// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/base/unknown_key.hpp>

#include <algorithm>

namespace segue {

std::optional<std::string> problem_of_key(std::string_view key, std::span<const std::string> known) {
  if (key.starts_with("x-") || std::ranges::find(known, key) != known.end()) return std::nullopt;
  const std::string hint = did_you_mean(key, known);
  return "the key " + quote(key) + " is not known" +
         (hint.empty() ? "; a key of your own begins with 'x-'" : hint);
}

}  // namespace segue
