// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/node_journal.hpp>
#include <segue/mission_engine/engine.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace segue::convert {

/// The state at the begin of an opaque subtree, by which its changes are found at its end.
class SubtreeWatch {
 public:
  /// `values`: those of the world that it may change.
  SubtreeWatch(const mission::MissionPart& part, std::vector<std::string> values);
  /// The changes of the subtree, after the run of the engine.
  [[nodiscard]] SubtreeChanges changes(const mission::Engine& engine) const;

 private:
  std::vector<std::string> values_;
  mission::World::Facts facts_;
  mission::Units::Counts units_;
  std::shared_ptr<mission::Iterations> iterations_;
  std::vector<std::uint32_t> begun_;  ///< by state
  bool has_data_;                     ///< which follow each change of a fact
};

}  // namespace segue::convert
