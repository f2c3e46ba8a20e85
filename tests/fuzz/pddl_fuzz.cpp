// SPDX-License-Identifier: Apache-2.0
// Three texts, between them a '%' on its own: a domain, a problem, a plan.
#include "require.hpp"

#include <segue/pddl/pddl.hpp>
#include <segue/task_network/order.hpp>

#include <cstddef>
#include <cstdint>

using segue::fuzz::require;
using namespace segue;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t first = text.find('%');
  const std::size_t second = first == std::string_view::npos ? first : text.find('%', first + 1);
  if (second == std::string_view::npos) return 0;
  Diagnostics diagnostics;
  const auto plan = pddl::read_pddl({text.substr(0, first), "domain"},
                                    {text.substr(first + 1, second - first - 1), "problem"},
                                    {text.substr(second + 1), "plan"}, diagnostics);
  require(plan.has_value() != diagnostics.has_errors(), "a refusal says why");
  if (!plan) return 0;
  require(plan->steps.size() == plan->network.size(), "every step is a node");
  for (const auto rule : {task_network::OrderRule::Epoch, task_network::OrderRule::Goal})
    require(task_network::derive_order(plan->network, rule).size() == plan->network.size(),
            "every node has its place");
  return 0;
}
