// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/world_view.hpp>
#include <segue/type/value.hpp>

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::mission {

/// A fact's name and arguments: "at(box,table)" is at, {box, table}.
struct FactParts {
  std::string predicate;
  std::vector<std::string> arguments;
};
/// The parts of a fact without blanks, as WorldView::facts() has it.
[[nodiscard]] FactParts parts_of(std::string_view fact);

/// The effects of changes of facts on data of type T that are attached to a world, such as a scene whose box
/// moves into the gripper with "+holding(box)". Functions are called on the engine's thread, in both modes,
/// also ahead of time for predicted worlds, each time with a copy of its own; so they depend on nothing but
/// the data and the arguments, change nothing else, do not block and do not throw. Changes come in the order
/// of the mission, but for those of states side by side that run sequentially, which come as these end:
/// functions must come to the same data then, as where each fact has a part of the data for itself.
template <class T>
class WorldEffects {
 public:
  using Arguments = std::span<const std::string>;
  using Effect = std::function<void(T& data, Arguments arguments)>;

  /// "+holding": facts of that name that become true; "-holding": false. Several for one are called in the
  /// order in which they were added.
  WorldEffects& on(std::string sign_and_predicate, Effect effect) {
    effects_[std::move(sign_and_predicate)].push_back(std::move(effect));
    return *this;
  }
  /// How scripts see the data (`self.world.data`). On the engine's thread; must not throw.
  WorldEffects& shown_as(std::function<type::Value(const T& data)> show) {
    show_ = std::move(show);
    return *this;
  }

  void apply(T& data, const std::string& fact, bool holds) const {
    const FactParts parts = parts_of(fact);
    const auto found = effects_.find((holds ? "+" : "-") + parts.predicate);
    if (found == effects_.end()) return;
    for (const Effect& effect : found->second)
      effect(data, parts.arguments);
  }
  [[nodiscard]] type::Value show(const T& data) const { return show_ ? show_(data) : type::Value(); }

 private:
  std::map<std::string, std::vector<Effect>> effects_;
  std::function<type::Value(const T& data)> show_;
};

/// Data of a type that can be copied, with their effects. A copy of the world shares them until one changes.
template <class T>
class DataWithEffects final : public WorldData {
 public:
  DataWithEffects(T data, std::shared_ptr<const WorldEffects<T>> effects)
      : data_(std::move(data)), effects_(std::move(effects)) {}

  [[nodiscard]] std::shared_ptr<WorldData> clone() const override {
    return std::make_shared<DataWithEffects>(*this);
  }
  void changed(const std::string& fact, bool holds) override { effects_->apply(data_, fact, holds); }
  [[nodiscard]] type::Value shown() const override { return effects_->show(data_); }
  [[nodiscard]] const T& data() const { return data_; }

 private:
  T data_;
  std::shared_ptr<const WorldEffects<T>> effects_;
};

/// The data with their effects, to be attached to the world of a run: request.world_data.emplace("scene",
/// world_data(scene, effects)).
template <class T>
[[nodiscard]] std::shared_ptr<const WorldData> world_data(T initial, WorldEffects<T> effects) {
  return std::make_shared<const DataWithEffects<T>>(
      std::move(initial), std::make_shared<const WorldEffects<T>>(std::move(effects)));
}

/// The data that world_data() has attached under that name, as they are in this world; null if there are
/// none, or they are of another type.
template <class T>
[[nodiscard]] std::shared_ptr<const T> data_of(const WorldView& world, std::string_view name) {
  const auto attached = world.attached<DataWithEffects<T>>(name);
  return attached ? std::shared_ptr<const T>(attached, &attached->data()) : nullptr;
}

}  // namespace segue::mission
