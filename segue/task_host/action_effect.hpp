// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

namespace segue::task_host {

/// Whether the effect of an action can be seen in what a host observes. ApplyConfig, HandOver and
/// CallOperation leave nothing to be seen for certain: false.
bool took_effect(const model::Action& action, const model::Network& observed);

}  // namespace segue::task_host
