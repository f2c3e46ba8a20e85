// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>

#include <string>
#include <vector>

/// Several controllers at once: a robot that drives while its arm works runs the union of two networks. Pure;
/// linear in the size of the networks.
namespace segue::solve {

/// Something that two networks need, each in a way of its own, so that they cannot run at once.
struct Conflict {
  std::string what;    ///< "task drive", "device wheels on host localhost", "input drive.command", ...
  std::string reason;  ///< a sentence that names both networks
  friend bool operator==(const Conflict&, const Conflict&) = default;
};

/// Why the two cannot run at once; empty: they can. They conflict where a task that both have is not defined
/// equally (configuration, state, process); where different tasks hold one device, or take one place in a
/// process; where a process differs in more than its tasks; where two ports are connected with different
/// policies; where different ports write to an input of which one connection keeps only the newest sample
/// (Policy::kind Data), so that they would overwrite each other; and where their union is not valid. Both
/// must have passed validation of structure; unknown components are assumed to claim no devices.
std::vector<Conflict> conflicts(const model::Network& a, const model::Network& b,
                                const model::ComponentCatalog& catalog);

/// Inputs of tasks of `on` that `by` writes to and `on` does not, so that in their union these tasks get
/// samples that they would not get in `on` alone. No conflict where both are wanted; but what merely runs on
/// must not do that to what is wanted.
std::vector<Conflict> influences(const model::Network& by, const model::Network& on);

/// The union, named "a+b" after the networks in their order; its version is combined in the same way, where
/// all have one. InvalidState where two of them conflict; the error names all reasons.
Result<model::Network> combine(const std::vector<model::Network>& networks,
                               const model::ComponentCatalog& catalog);

}  // namespace segue::solve
