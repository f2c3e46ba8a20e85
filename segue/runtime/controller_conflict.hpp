// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>
#include <segue/solve/combine.hpp>

namespace segue::runtime {

/// Why two controllers cannot run at once; with `influence`: they can, but `a` changes what tasks of `b` get
/// (solve::influences).
struct ControllerConflict {
  model::NetworkName a;
  model::NetworkName b;
  solve::Conflict conflict;
  bool influence = false;
};

}  // namespace segue::runtime
