// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/action_runner.hpp>
#include <segue/mission_script/script_memory.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

/// For tests only.
namespace segue::convert {

/// A number that each state has as its persistent variable, kept as the process of the scripts keeps them.
/// For one thread.
class KeptNumbers {
 public:
  /// Takes note of what has been decided since. To be called when an execution begins.
  void update() {
    for (const auto& [execution, counts] : decisions_->take_decisions()) {
      const auto found = aside_.find(execution);
      if (found == aside_.end()) continue;
      if (counts) kept_[found->second.first] = {execution, found->second.second};
      aside_.erase(found);
    }
  }

  /// What the execution begins with; nothing where it was discarded. `from`: who has left it.
  [[nodiscard]] std::optional<std::uint64_t> before(const mission::ActionCall& call,
                                                    std::uint64_t& from) const {
    const auto found = kept_.find(call.path());
    const Kept kept = found == kept_.end() ? Kept{} : found->second;
    from = call.memory().value_or(kept.by);
    if (from == kept.by) return kept.number;
    const auto beside = aside_.find(from);
    return beside == aside_.end() ? std::nullopt : std::optional(beside->second.second);
  }

  /// The execution leaves `number`: at once, or aside until it counts.
  void leave(const mission::ActionCall& call, std::uint64_t from, std::uint64_t number,
             mission::Ending& ending) {
    if (!call.may_be_discarded()) {
      kept_[call.path()] = {0, number};
      return;
    }
    ending.memory = ++executions_;
    aside_[ending.memory] = {call.path(), number};
    ending.pending = mission::detail::ScriptMemory::changes(
        decisions_, {call.path(), ending.memory, from, call.memory().has_value()});
  }

 private:
  struct Kept {
    std::uint64_t by = 0;
    std::uint64_t number = 0;
  };
  std::shared_ptr<mission::detail::ScriptMemory> decisions_ =
      std::make_shared<mission::detail::ScriptMemory>();
  std::map<std::string, Kept> kept_;
  std::map<std::uint64_t, std::pair<std::string, std::uint64_t>> aside_;
  std::uint64_t executions_ = 0;
};

}  // namespace segue::convert
