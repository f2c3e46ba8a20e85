// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/file_stamp.hpp>
#include <segue/base/result.hpp>
#include <segue/model/halt.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/controller_change.hpp>

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace segue::model {
class ComponentCatalog;
}

namespace segue::runtime {

/// A file as it was read.
struct LoadedFile {
  std::filesystem::path path;
  std::string digest;  ///< SHA-256
  FileStamp stamp;
  std::chrono::system_clock::time_point read;
  bool is_model = false;  ///< component models, which a running robot does not load anew
};

/// The controllers of a robot and what belongs to them, from all its files at one moment.
struct ControllerSet {
  std::vector<model::Network> controllers;
  std::optional<model::NetworkName> fallback;
  std::optional<model::Halt> halt{};
  std::vector<model::Transition> transitions{};  ///< that are written by hand, of different names
  std::vector<LoadedFile> files{};
};

using Controllers = std::map<model::NetworkName, model::Network>;

/// The controller of that name, or the union of several (solve::combine); the empty name is the empty
/// network. NotFound; InvalidState where they cannot run at once.
Result<model::Network> find_controller(const Controllers& controllers, const model::NetworkName& name,
                                       const model::ComponentCatalog& catalog);

/// By name. Controllers of one version are equal; where both have none, they are compared. `runs` names what
/// runs.
std::vector<ControllerChange> compare(const Controllers& before, const Controllers& after,
                                      const model::NetworkName& runs);

}  // namespace segue::runtime
