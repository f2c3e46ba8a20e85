// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>

namespace segue::model {

/// Advice about a network without errors that will run, but probably not as meant or not as well as it could:
/// tasks that never update, inputs that nothing writes, inputs with several writers, buffers that their
/// reader cannot empty, chains that change the process at each hop, processes that all run on one processor
/// ("Controllers" in the manual). Each is a Severity::Hint. Linear in the size of the network.
Diagnostics hints(const Network& network, const ComponentCatalog& catalog);

}  // namespace segue::model
