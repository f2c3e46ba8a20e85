// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/distributed/distributed_task_host.hpp>
#include <segue/distributed/sites.hpp>

namespace segue::distributed::detail {

/// Why a network cannot run on the robot's hosts as they are now; see DistributedTaskHost::check().
Diagnostics check_hosts(const model::Network& network, const Sites& sites,
                        const model::ComponentCatalog& catalog, const DistributedOptions& options);

/// Whether a library of the host has that component, as far as the host has been asked.
bool offers(const Site& site, const model::ComponentName& component);

}  // namespace segue::distributed::detail
