// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/footprint.hpp>
#include <segue/mission/world_effects.hpp>
#include <segue/mission/world_view.hpp>

#include <algorithm>

namespace segue::mission {

FactParts parts_of(std::string_view fact) {
  const std::size_t open = fact.find('(');
  FactParts parts{std::string(fact.substr(0, open)), {}};
  if (open == std::string_view::npos) return parts;
  std::string_view rest = fact.substr(open + 1, fact.size() - open - 2);
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    parts.arguments.emplace_back(rest.substr(0, comma));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  return parts;
}

bool WorldView::holds(std::string_view fact) const {
  if (facts_.contains(fact)) return true;
  const auto parsed = parse_fact(fact, "");
  if (!parsed) return false;
  const auto grounded = ground(*parsed);
  return grounded && facts_.contains(grounded->text);
}

}  // namespace segue::mission
