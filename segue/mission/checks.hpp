// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/mission/index.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// The parts of validate(). Internal; each reports and goes on.
namespace segue::mission::detail {

/// All of them.
Diagnostics validate(const MissionIndex& index);
/// Actions by themselves: values, outcomes and placeholders that mean something.
void check_actions(const Mission& mission, Diagnostics& diagnostics);
/// Facts that contradict each other, stand there twice, or can never become as somebody needs them.
void check_facts(const Mission& mission, Diagnostics& diagnostics);
/// Resources that are needed but can never be there.
void check_resources(const Mission& mission, Diagnostics& diagnostics);
/// Names, transitions, reachability, deciders, recursion of libraries.
void check_control(const MissionIndex& index, Diagnostics& diagnostics);
/// Ports and their types, writers that can never be.
void check_data(const MissionIndex& index, Diagnostics& diagnostics);

/// The siblings that every child of a hierarchy leads to, by position among the children.
class Successors {
 public:
  Successors() = default;
  Successors(const MissionIndex& index, const State& hierarchy);
  [[nodiscard]] std::size_t size() const { return first_.empty() ? 0 : first_.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t child) const {
    return {all_.data() + first_[child], all_.data() + first_[child + 1]};
  }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> all_;
};
/// Which children the start of a hierarchy leads to.
std::vector<bool> reached(const MissionIndex& index, StateIndex hierarchy, const Successors& successors);

void check_value(const Port& declared, const type::Value& value, const std::string& what, const Place& where,
                 const Mission& mission, Diagnostics& diagnostics);

/// ", did you mean 'x'?" among ports.
std::string suggestion(const std::vector<Port>& ports, const std::string& name);
/// "state 'look'", "the mission" or "library 'grasp'".
std::string told(const Mission& mission, StateIndex state);

}  // namespace segue::mission::detail
