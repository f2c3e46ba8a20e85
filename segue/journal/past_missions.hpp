// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/database.hpp>
#include <segue/type/value.hpp>

/// The runs of missions that a journal has. For this folder only.
namespace segue::journal::detail {

/// Answers "missions" of answer_about_past().
Result<type::Value> missions(Database& database, const type::Value& question);
/// Answers "mission" of answer_about_past().
Result<type::Value> mission(Database& database, const type::Value& question);

}  // namespace segue::journal::detail
