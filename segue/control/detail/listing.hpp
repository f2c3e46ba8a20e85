// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/detail/wire.hpp>

#include <vector>

namespace segue::control::detail {

/// Writes a list of outcomes into the list that `init` makes.
template <class Outcome, class Init>
auto listing(Init init) {
  return [init](std::vector<Outcome>& outcomes, auto results) {
    encode_list(outcomes, init(results, count_of(outcomes)),
                [](const Outcome& outcome, auto builder) { encode(outcome, builder); });
  };
}

}  // namespace segue::control::detail
