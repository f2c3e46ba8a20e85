// SPDX-License-Identifier: Apache-2.0
//
// Offers a component of the same name as first.cpp.
#include <segue/task/component.hpp>

namespace duplicate {
class Component final : public segue::task::Component {};
}  // namespace duplicate

SEGUE_COMPONENT(duplicate::Component)
