// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace segue::mission {

/// Data of a program that are attached to the world of a run, such as a geometric model, and that follow its
/// facts. Actions get them with the world that they read (ActionCall::world()).
class WorldData {
 public:
  virtual ~WorldData() = default;
  /// A copy that can change without this one being touched.
  [[nodiscard]] virtual std::shared_ptr<WorldData> clone() const = 0;
  /// The fact "at(box,table)" has become true or false. On the engine's thread; not for facts that keep
  /// their value, and for those of an opaque subtree at its end.
  virtual void changed(const std::string& fact, bool holds) = 0;
  /// The data as scripts see them, `self.world.data[name]`; null: not at all.
  [[nodiscard]] virtual type::Value shown() const { return {}; }
};
/// Data by the names under which actions ask for them.
using AttachedData = std::map<std::string, std::shared_ptr<const WorldData>, std::less<>>;

/// The world as one execution may take it to be. A snapshot: it does not change, and any thread may read it.
class WorldView {
 public:
  using Facts = std::set<std::string, std::less<>>;

  WorldView(Facts facts, AttachedData data) : facts_(std::move(facts)), data_(std::move(data)) {}

  /// "at(box, table)", or without the blank.
  [[nodiscard]] bool holds(std::string_view fact) const;
  /// All facts that hold, as "at(box,table)".
  [[nodiscard]] const Facts& facts() const { return facts_; }
  /// Null if nothing of that name is attached, or it is of another type.
  template <class T>
  [[nodiscard]] std::shared_ptr<const T> attached(std::string_view name) const {
    const auto found = data_.find(name);
    return found == data_.end() ? nullptr : std::dynamic_pointer_cast<const T>(found->second);
  }
  [[nodiscard]] const AttachedData& data() const { return data_; }

 private:
  Facts facts_;
  AttachedData data_;
};

/// Attached data that are copied before they change, if anybody else may read them. One thread at a time.
class SharedWorldData {
 public:
  explicit SharedWorldData(std::shared_ptr<const WorldData> data) : shared_(std::move(data)) {}

  void changed(const std::string& fact, bool holds) {
    if (!own_) own_ = shared_->clone();
    own_->changed(fact, holds);
  }
  /// The data as they are now; the returned object does not change any more.
  [[nodiscard]] std::shared_ptr<const WorldData> share() const {
    if (own_) shared_ = std::exchange(own_, nullptr);
    return shared_;
  }

 private:
  mutable std::shared_ptr<const WorldData> shared_;
  mutable std::shared_ptr<WorldData> own_;  ///< changed since; null: `shared_` is as it is
};

}  // namespace segue::mission
