// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/mission/program.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace segue::mission {

/// The executions of states as a tree, in the order in which they began. Owned by an engine; to be read on
/// the engine's thread.
class History {
 public:
  static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);

  struct Item {
    std::uint32_t parent = kNone;  ///< the item of the parent state
    StateIndex state = kNoState;
    std::uint32_t iteration = 0;  ///< how often the state had begun before
    Outcome outcome = 0;
    bool ended = false;
    bool undone = false;  ///< by a later step back
    TimePoint began{};
    TimePoint end{};
  };

  /// The time in which an item waited for units of a resource that a robot did not show.
  struct UnitWait {
    std::string resource;
    TimePoint from{};
    TimePoint until{};
  };

  [[nodiscard]] const std::vector<Item>& items() const { return items_; }
  /// Null: it did not wait so.
  [[nodiscard]] const UnitWait* unit_wait(std::uint32_t item) const {
    const auto found = unit_waits_.find(item);
    return found == unit_waits_.end() ? nullptr : &found->second;
  }
  /// The error with which an item aborted; empty if it did not.
  [[nodiscard]] std::string_view error(std::uint32_t item) const {
    const auto found = errors_.find(item);
    return found == errors_.end() ? std::string_view{} : std::string_view(found->second);
  }
  /// "fetch/grasp"; continues into libraries.
  [[nodiscard]] std::string path(const Program& program, std::uint32_t item) const;

  std::uint32_t begin(Item item) {
    items_.push_back(item);
    return static_cast<std::uint32_t>(items_.size() - 1);
  }
  /// Sets the begin of an item that had to wait.
  void begin_late(std::uint32_t item, TimePoint when) { items_[item].began = when; }
  void waited(std::uint32_t item, UnitWait wait) { unit_waits_.insert_or_assign(item, std::move(wait)); }
  void end(std::uint32_t item, Outcome outcome, TimePoint when, const std::string& error) {
    items_[item].outcome = outcome;
    items_[item].ended = true;
    items_[item].end = when;
    if (!error.empty()) errors_[item] = error;
  }
  void undo(std::uint32_t item) { items_[item].undone = true; }

 private:
  std::vector<Item> items_;
  std::unordered_map<std::uint32_t, std::string> errors_;
  std::unordered_map<std::uint32_t, UnitWait> unit_waits_;
};

}  // namespace segue::mission
