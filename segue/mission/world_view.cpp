// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/footprint.hpp>
#include <segue/mission/world_view.hpp>

namespace segue::mission {

bool WorldView::holds(std::string_view fact) const {
  if (facts_.contains(fact)) return true;
  const auto parsed = parse_fact(fact, "");
  if (!parsed) return false;
  const auto grounded = ground(*parsed);
  return grounded && facts_.contains(grounded->text);
}

}  // namespace segue::mission
