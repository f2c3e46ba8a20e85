// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/network_index.hpp>

/// The two depths of validation. Internal.
namespace segue::model::detail {

/// Names, references, identities: needs no component to be known.
void check_structure(const Network& network, const NetworkIndex& index, Diagnostics& diagnostics);

/// Components, ports, types, properties, devices.
void check_components(const Network& network, const NetworkIndex& index, const ComponentCatalog& catalog,
                      Diagnostics& diagnostics);

}  // namespace segue::model::detail
