// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/database.hpp>
#include <segue/journal/entries.hpp>
#include <segue/model/action_times.hpp>

#include <cstdint>

/// What was learnt, as rows: they stay when the transitions behind them are removed.
namespace segue::journal::detail {

/// Every row that makes sense; `invalid` counts the others.
Result<model::ActionTimes> read_times(Database& database, std::uint64_t& invalid);

/// Adds to the rows in the file, whoever wrote them last, and keeps `times` equal to what is there. Needs a
/// transaction.
Result<void> learn_from(Database& database, const Lesson& lesson, std::int64_t time,
                        model::ActionTimes& times);

/// Removes the rows that were not added to for longest, where there are very many.
Result<void> remove_old_statistics(Database& database);

}  // namespace segue::journal::detail
