// SPDX-License-Identifier: Apache-2.0
#include <segue/task/component.hpp>

namespace duplicate {
class Component final : public segue::task::Component {};
}  // namespace duplicate

SEGUE_COMPONENT(duplicate::Component)
