// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>

#include <set>
#include <string>

/// Set operations on networks. A robot runs the union of its controller, standby tasks of other controllers
/// and leftovers of earlier ones. Linear in the size of the networks.
namespace segue::model {

/// Union: all of `first`, plus those parts of `second` that it lacks. Tasks are compared by id, processes by
/// key (the placements of both are merged), connections by value. Keeps the name of `first`.
Network unite(Network first, const Network& second);

/// Difference: the parts of `all` that are not in `part`, compared as in unite(). A process that is in both
/// is kept only with the placements of remaining tasks. The result has no name.
Network subtract(const Network& all, const Network& part);

/// The network without these computers: their processes, the tasks there and all connections of these tasks
/// are left out.
Network without_hosts(Network network, const std::set<HostName>& hosts);

/// Texts of its connections, equal for equal ones: both ports and the policy.
std::set<std::string> connection_texts(const Network& network);

/// Whether every part of `part` is in `all`, with equal definition and state.
bool includes(const Network& all, const Network& part);

}  // namespace segue::model
