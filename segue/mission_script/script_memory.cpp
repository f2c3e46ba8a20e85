// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_script/script_memory.hpp>

namespace segue::mission::detail {

class ScriptMemory::Changes final : public PendingChanges {
 public:
  Changes(std::shared_ptr<ScriptMemory> memory, Use use) : memory_(std::move(memory)), use_(std::move(use)) {}
  ~Changes() override {
    if (!applied_) decide(false);
  }

  [[nodiscard]] bool empty() const override { return false; }
  [[nodiscard]] bool needs_turn() const override { return !use_.told; }

  [[nodiscard]] bool valid() const override {
    if (use_.told) return true;
    const Lock guard(memory_->mutex_);
    const auto last = memory_->last_.find(use_.path);
    return memory_->ended_ || (last == memory_->last_.end() ? 0 : last->second) == use_.from;
  }

  Result<void> apply() override {
    applied_ = true;
    decide(true);
    return {};
  }

 private:
  void decide(bool counts) const {
    const Lock guard(memory_->mutex_);
    if (memory_->ended_) return;
    if (counts) memory_->last_[use_.path] = use_.execution;
    memory_->decisions_.emplace_back(use_.execution, counts);
  }

  const std::shared_ptr<ScriptMemory> memory_;
  const Use use_;
  bool applied_ = false;
};

std::shared_ptr<PendingChanges> ScriptMemory::changes(std::shared_ptr<ScriptMemory> memory, Use use) {
  return std::make_shared<Changes>(std::move(memory), std::move(use));
}

std::vector<std::pair<std::uint64_t, bool>> ScriptMemory::take_decisions() {
  const Lock guard(mutex_);
  return std::exchange(decisions_, {});
}

void ScriptMemory::end() {
  const Lock guard(mutex_);
  ended_ = true;
  decisions_.clear();
}

}  // namespace segue::mission::detail
