// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/pending_changes.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

namespace segue::convert {

/// All changes of an action: those of global variables, and those that its runner keeps aside. Either may be
/// null.
class AllChanges final : public PendingChanges {
 public:
  AllChanges(std::shared_ptr<PendingChanges> globals, std::shared_ptr<PendingChanges> other)
      : parts_{std::move(globals), std::move(other)} {}
  [[nodiscard]] bool empty() const override {
    return std::ranges::all_of(parts_, [](const auto& part) { return !part || part->empty(); });
  }
  [[nodiscard]] bool needs_turn() const override {
    return std::ranges::any_of(parts_,
                               [](const auto& part) { return part && !part->empty() && part->needs_turn(); });
  }
  [[nodiscard]] bool valid() const override {
    return std::ranges::all_of(parts_, [](const auto& part) { return !part || part->valid(); });
  }
  /// Only global variables, which come first, may refuse.
  Result<void> apply() override {
    for (const auto& part : parts_) {
      if (!part) continue;
      if (auto applied = part->apply(); !applied) return applied;
    }
    return {};
  }

 private:
  const std::array<std::shared_ptr<PendingChanges>, 2> parts_;
};

}  // namespace segue::convert
