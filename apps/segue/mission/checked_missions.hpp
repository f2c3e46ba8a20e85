// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/convert/ahead_of_failures.hpp>
#include <segue/mission_script/script_check.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>
#include <segue/type/value.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace segue::cli {

/// The controllers and pools of the robot that runs a mission, and the models of their components.
struct RobotControllers {
  const std::vector<model::Network>& networks;
  const std::vector<model::Pool>& pools;
  const std::vector<model::UnitStock>& units;
  const model::ComponentCatalog& catalog;
};

/// The missions and task networks that were checked: what is wrong with them, and what may happen in a
/// concurrent run of them although something earlier fails, or has not been done yet.
class CheckedMissions {
 public:
  explicit CheckedMissions(const std::vector<std::string>& libraries) : libraries_(libraries) {}

  /// Reads and validates the file, and compiles its scripts; blocks. With `robot` it also checks all that the
  /// mission asks of that robot.
  void check(const std::filesystem::path& file, Diagnostics& diagnostics,
             const RobotControllers* robot = nullptr);
  /// Prints the states that may act or sense ahead, for people.
  void print() const;
  /// The fields of `diagnostics`, `ahead` and `senses_ahead`.
  [[nodiscard]] type::Value to_value(const Diagnostics& diagnostics) const;

 private:
  struct Entry {
    std::string file;
    convert::AheadOfFailures found;
  };
  const std::vector<std::string>& libraries_;
  mission::ScriptCompiler scripts_;
  std::vector<Entry> entries_;  ///< only where there is something to tell
};

}  // namespace segue::cli
