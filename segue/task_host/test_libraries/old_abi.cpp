// SPDX-License-Identifier: Apache-2.0
//
// A component library as an older Segue would have built it.
#include <segue/task/component.hpp>

namespace {
const segue::task::detail::Registration kOld{
    "old::Component", "segue-0.0/0", []() -> std::unique_ptr<segue::task::Component> { return nullptr; }};
}  // namespace
