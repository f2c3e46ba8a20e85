// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/mission.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace segue::mission {

/// What a state shows to its surroundings, wherever that is declared. Points into the mission.
struct Interface {
  const std::vector<Port>* inputs = nullptr;
  const std::vector<Port>* outputs = nullptr;
  const std::vector<std::string>* outcomes = nullptr;
};

/// Finds by name. Valid as long as the mission lives unchanged; reading from several threads is fine.
class MissionIndex {
 public:
  explicit MissionIndex(const Mission& mission);

  [[nodiscard]] const Mission& mission() const { return mission_; }
  /// nullptr or kNoState where there is none; of two with the same name the first.
  [[nodiscard]] const Action* action(const ActionName& name) const;
  [[nodiscard]] const Library* library(std::string_view name) const;
  [[nodiscard]] StateIndex child(StateIndex parent, const StateId& id) const;
  /// Nothing where the state's action or library is not there, or libraries only use each other in a circle.
  [[nodiscard]] std::optional<Interface> interface(StateIndex state) const;

 private:
  using Child = std::pair<StateIndex, std::string_view>;
  struct HashChild {
    std::size_t operator()(const Child& child) const noexcept {
      return std::hash<std::string_view>{}(child.second) ^ (std::size_t{child.first} * 0x9e3779b97f4a7c15ULL);
    }
  };

  const Mission& mission_;
  std::unordered_map<std::string_view, const Action*> actions_;
  std::unordered_map<std::string_view, const Library*> libraries_;
  std::unordered_map<Child, StateIndex, HashChild> children_;
};

/// The position of the port of that name; nothing where there is none.
std::optional<std::size_t> position(const std::vector<Port>& ports, std::string_view name);

}  // namespace segue::mission
