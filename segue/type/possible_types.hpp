// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/described_type.hpp>

#include <span>

namespace segue::type::detail {

/// Whether a container can be read and written item by item: text, bits, or a sequence that can be refilled.
[[nodiscard]] inline bool has_items(const DescribedType& container) {
  return container.shape->type.is_string() || container.sequence.reuse != nullptr ||
         container.conversion.to_value == &bits_to_value;
}

/// Finds out which types an encoding can have. `possible(type)` is where that is noted, `is_known(type)`
/// whether it has the type itself, `has_parts(type)` whether that is noted of all its parts. Types may
/// contain themselves, so all are assumed possible until one of their parts is not.
template <class Possible, class IsKnown, class HasParts>
void find_possible(std::span<DescribedType* const> types, Possible possible, IsKnown is_known,
                   HasParts has_parts) {
  for (DescribedType* type : types)
    possible(*type) = is_known(*type);
  for (bool changed = true; changed;) {
    changed = false;
    for (DescribedType* type : types) {
      if (!possible(*type) || has_parts(*type)) continue;
      possible(*type) = false;
      changed = true;
    }
  }
}

}  // namespace segue::type::detail
