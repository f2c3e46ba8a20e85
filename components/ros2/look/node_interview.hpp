// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/participant.hpp"

#include <segue/base/clock.hpp>
#include <segue/type/value.hpp>

#include <memory>
#include <stop_token>

namespace ros2 {

/// How a node is asked.
struct Interview {
  std::shared_ptr<Participant> participant;
  segue::Duration patience = std::chrono::seconds(5);  ///< for all answers of one node
  bool types = false;  ///< also the definitions of its types that are not built in
  std::stop_token stop;
};

/// Asks a node, one of segue::ros2::describe_nodes(), for what the graph does not tell, and adds it: `state`
/// of a managed node, "" where it does not say; `parameters`: [{name, kind, value, read_only, description,
/// constraints, range: {from, to, step}}]; `files` of its types: {PATH: TEXT}; `problems`: a text for each
/// question that it does not answer. Blocks; any thread.
void ask(const Interview& interview, segue::type::ValueMap& node);

}  // namespace ros2
