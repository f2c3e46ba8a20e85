// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/database.hpp>
#include <segue/journal/entries.hpp>
#include <segue/model/action_times.hpp>

#include <cstdint>
#include <string>
#include <vector>

/// Statistics of durations, as rows. They are kept when the transitions behind them are removed.
namespace segue::journal::detail {

/// Reads all valid rows of that robot folder ("": those of robots without one); `invalid` counts the others.
Result<model::ActionTimes> read_times(Database& database, const std::string& folder, std::uint64_t& invalid);

/// The folders that have rows, the one that learned last first.
Result<std::vector<std::string>> folders_with_times(Database& database);

/// Adds samples to the rows of that folder in the file, which another process may have changed, and updates
/// `times` to the result. Requires a transaction.
Result<void> add_samples(Database& database, const std::string& folder, const DurationSamples& samples,
                         std::int64_t time, model::ActionTimes& times);

/// Removes the rows that were updated least recently if there are very many.
Result<void> remove_old_statistics(Database& database);

}  // namespace segue::journal::detail
