// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace segue::runtime {

/// How a controller of one set differs from that of another one.
struct ControllerChange {
  enum class Kind { Added, Changed, Removed };
  model::NetworkName controller;
  Kind kind = Kind::Changed;
  bool runs = false;         ///< it runs
  std::string file;          ///< of the new version; Removed: of the old one
  std::string from_version;  ///< model::Network::version; Added: empty
  std::string to_version;    ///< Removed: empty
  std::vector<std::string>
      edits;  ///< Changed: model::changes(), the first few; none: the network is the same
};
std::string_view to_string(ControllerChange::Kind kind);

}  // namespace segue::runtime
