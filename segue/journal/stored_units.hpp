// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/journal/database.hpp>
#include <segue/model/robot.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::journal {

/// How many units there are of the resources that a robot keeps (model::Robot::units), in an SQLite file that
/// outlives the robot. It also has which executions of missions have changed them, so that none counts twice,
/// however often it is reported: of the last hundred thousand changes, and all of the run that was reported
/// last. What a function has changed is on the disk when it returns. Thread safe; functions block. Each one
/// tries anew where the file could not be opened.
class StoredUnits {
 public:
  using Counts = std::map<std::string, std::uint32_t, std::less<>>;
  using Changes = std::map<std::string, std::int64_t, std::less<>>;
  /// Asked right before something is changed, and while nobody else can change anything: whether this may be.
  /// Must not block.
  using Permit = std::function<Result<void>()>;
  struct Execution {
    std::string name;  ///< unique in its run
    Changes changes;
  };

  /// `file` and its folder are created once there is something to keep; empty: Unsupported, whatever is
  /// asked. `robot`: whose counts these are, since several robots may share the file. `declared`: the units
  /// of its file.
  StoredUnits(std::filesystem::path file, std::string robot, std::vector<model::UnitStock> declared);

  [[nodiscard]] Result<Counts> counts();
  /// Returns the count before. NotFound.
  Result<std::uint32_t> set(std::string_view name, std::uint32_t count, const Permit& permit);
  /// A run begins with these counts, or goes on that has begun with them. NotFound; InvalidState where
  /// somebody else has changed one of them since.
  Result<void> begin(std::string_view run, const Counts& begun, const Permit& permit);
  /// Adds the changes of all executions of the run that were not added before, or of none where this fails. A
  /// count stays between 0 and the greatest of its type. NotFound.
  Result<void> change(std::string_view run, const std::vector<Execution>& executions, const Permit& permit);

 private:
  Result<detail::Database*> open() SEGUE_REQUIRES(mutex_);
  Result<std::uint32_t> count_of(detail::Database& database, std::string_view name) const;
  Result<void> write_count(detail::Database& database, std::string_view name, std::int64_t count) const;
  Result<void> check_begin(detail::Database& database, std::string_view run, std::string_view name,
                           std::uint32_t begun) const;
  Result<void> add(detail::Database& database, std::string_view run, const Execution& execution) const;
  /// Calls `act` in a transaction that is on the disk afterwards.
  Result<void> write(const Permit& permit, const std::function<Result<void>(detail::Database&)>& act)
      SEGUE_REQUIRES(mutex_);

  const std::filesystem::path file_;
  const std::string robot_;
  const std::vector<model::UnitStock> declared_;
  Mutex mutex_;  ///< protects all below
  std::optional<detail::Database> database_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::journal
