// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/race_order.hpp>

namespace segue::convert {

using task_network::NodeId;

bool beside_or_after_race(const MissionPlan& plan, NodeId acts, NodeId fails) {
  const mission::Program& program = plan.program();
  for (const auto* branch = plan[fails].branch.get(); branch != nullptr; branch = branch->around.get()) {
    const mission::StateIndex container = program.node(branch->child).parent;
    if (program.node(container).kind != mission::StateKind::Preemptive) continue;
    const auto* own = plan[acts].branch.get();
    while (own != nullptr && own != branch)
      own = own->around.get();
    if (own == nullptr) return true;
  }
  return false;
}

}  // namespace segue::convert
