// SPDX-License-Identifier: Apache-2.0
//
// Units that exist, and that nobody can have at present (UnitLimits).
#include "concurrent_engine_implementation.hpp"

namespace segue::task_network {

void ConcurrentEngine::Implementation::limit(UnitLimits limits) {
  unit_waits_.ask(std::move(limits));
  wake();
}

/// Says of each node once that it waits because of a limit; where the limits will not change any more, the
/// first node aborts.
void ConcurrentEngine::Implementation::note_unit_waits() {
  if (options_.limited.empty()) return;
  unit_waits_.look(pool_);
  if (!unit_waits_.are_known()) return;
  for (const ResourcePool::Limited& one : unit_waits_.now()) {
    if (unit_waits_.began(one, events_.now()) && options_.waits_for_units) options_.waits_for_units(one);
  }
  if (unit_waits_.lost().empty()) return;
  for (const ResourcePool::Limited& one : unit_waits_.now()) {
    if (index(one.node) != prefix_) continue;
    unit_waits_.ended(one.node, events_.now());
    abandon(one.node);
    at(one.node).phase = Phase::Waiting;
    return refuse(one.node, fail(ErrorCode::InvalidState, unit_waits_.lost(), network_.label(one.node)));
  }
}

}  // namespace segue::task_network
