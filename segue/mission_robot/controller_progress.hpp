// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/controller_use.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace segue::mission {

/// How far an action that is a controller has got, as its run's journal has it. Told: with its controller,
/// the properties that it set, and how often each task that it watches had been updated then.
struct ControllerProgress {
  enum class Stage : std::uint8_t { Begins, Tells, Told };
  Stage stage = Stage::Begins;
  std::string controller;
  std::vector<MemberValue> properties{};
  std::map<std::string, std::uint64_t> updates{};

  [[nodiscard]] type::Value to_value() const;
  static ControllerProgress of(const type::Value& value);
};

}  // namespace segue::mission
