// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_script/script_memory.hpp>

namespace segue::mission::detail {

class ScriptMemory::Changes final : public PendingChanges {
 public:
  Changes(std::shared_ptr<ScriptMemory> memory, std::string path, std::uint64_t execution, std::uint64_t from)
      : memory_(std::move(memory)), path_(std::move(path)), execution_(execution), from_(from) {}
  ~Changes() override {
    if (!applied_) decide(false);
  }

  [[nodiscard]] bool empty() const override { return false; }

  [[nodiscard]] bool valid() const override {
    const Lock guard(memory_->mutex_);
    const auto last = memory_->last_.find(path_);
    return memory_->ended_ || (last == memory_->last_.end() ? 0 : last->second) == from_;
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
    if (counts) memory_->last_[path_] = execution_;
    memory_->decisions_.emplace_back(execution_, counts);
  }

  const std::shared_ptr<ScriptMemory> memory_;
  const std::string path_;
  const std::uint64_t execution_;
  const std::uint64_t from_;
  bool applied_ = false;
};

std::shared_ptr<PendingChanges> ScriptMemory::changes(std::shared_ptr<ScriptMemory> memory, std::string path,
                                                      std::uint64_t execution, std::uint64_t from) {
  return std::make_shared<Changes>(std::move(memory), std::move(path), execution, from);
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
