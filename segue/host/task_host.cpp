// SPDX-License-Identifier: Apache-2.0
#include <segue/host/task_host.hpp>

namespace segue::host {

Result<void> TaskHost::can_make(const model::ComponentName& /*component*/) const {
  return {};
}

void TaskHost::expect(const model::Network& /*target*/) {}

void TaskHost::conclude(const model::Transition& /*transition*/) {}

}  // namespace segue::host
