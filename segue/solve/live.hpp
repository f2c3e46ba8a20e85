// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component.hpp>
#include <segue/model/network.hpp>

namespace segue::solve::detail {

/// Whether the two definitions differ only in properties that the component declares live. A property that
/// only one of them sets differs.
bool differ_only_live(const model::Task& now, const model::Task& then, const model::ComponentModel* model);

}  // namespace segue::solve::detail
