// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_script/script_objects.hpp>

#include <utility>

namespace segue::mission::detail {

class ScriptObjects::Held final : public GlobalObject {
 public:
  Held(std::shared_ptr<ScriptObjects> objects, std::uint64_t number)
      : objects_(std::move(objects)), number_(number) {}
  ~Held() override {
    const Lock guard(objects_->mutex_);
    objects_->shown_.erase(number_);
    if (!objects_->ended_) objects_->released_.push_back(number_);
  }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

  [[nodiscard]] type::Value shown() const override {
    const Lock guard(objects_->mutex_);
    const auto found = objects_->shown_.find(number_);
    return found == objects_->shown_.end() ? type::Value() : found->second;
  }
  [[nodiscard]] bool is_of(const ScriptObjects& objects) const { return objects_.get() == &objects; }
  [[nodiscard]] std::uint64_t number() const { return number_; }

 private:
  const std::shared_ptr<ScriptObjects> objects_;
  const std::uint64_t number_;
};

std::shared_ptr<const GlobalObject> ScriptObjects::hold(const std::shared_ptr<ScriptObjects>& objects,
                                                        std::uint64_t number, type::Value shown) {
  {
    const Lock guard(objects->mutex_);
    objects->shown_[number] = std::move(shown);
  }
  return std::make_shared<const Held>(objects, number);
}

std::optional<std::uint64_t> ScriptObjects::number_of(const GlobalObject& object) const {
  const auto* held = dynamic_cast<const Held*>(&object);
  if (held == nullptr || !held->is_of(*this)) return std::nullopt;
  const Lock guard(mutex_);
  return ended_ ? std::nullopt : std::optional(held->number());
}

void ScriptObjects::show(std::uint64_t number, type::Value shown) {
  const Lock guard(mutex_);
  if (const auto found = shown_.find(number); found != shown_.end()) found->second = std::move(shown);
}

std::vector<std::uint64_t> ScriptObjects::take_released() {
  const Lock guard(mutex_);
  return std::exchange(released_, {});
}

void ScriptObjects::end() {
  const Lock guard(mutex_);
  ended_ = true;
  released_.clear();
}

}  // namespace segue::mission::detail
