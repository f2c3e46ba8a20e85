// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/component_facts.hpp>

#include <algorithm>

namespace segue::solve::detail {

namespace {

/// Whether every entry of `a` that is missing or different in `b` is a live property.
bool only_live_beyond(const type::ValueMap& a, const type::Value& b, const model::ComponentModel& model) {
  return std::all_of(a.begin(), a.end(), [&](const type::ValueMap::Entry& entry) {
    const type::Value* other = b.find(entry.first);
    if (other != nullptr && *other == entry.second) return true;
    const model::PropertyModel* property = model.find_property(entry.first);
    return property != nullptr && property->live;
  });
}

}  // namespace

bool differ_only_live(const model::Task& now, const model::Task& then, const model::ComponentModel* model) {
  if (model == nullptr || !now.properties.is_map() || !then.properties.is_map()) return false;
  if (now.config_names != then.config_names || now.activity != then.activity ||
      now.exclusive != then.exclusive) {
    return false;
  }
  return only_live_beyond(now.properties.as_map(), then.properties, *model) &&
         only_live_beyond(then.properties.as_map(), now.properties, *model);
}

}  // namespace segue::solve::detail
