// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/database.hpp>

#include <span>
#include <string_view>

/// The tables of a journal and how older files become newer ones.
namespace segue::journal::detail {

/// Step i brings a file of version i to version i + 1; the first makes everything in an empty file. Steps are
/// never changed once they are released: a new version is a new step.
std::span<const std::string_view> schema_steps();

/// Makes or brings up to date what is there, in one transaction. InvalidArgument where the file is of another
/// program, Unsupported where a newer Segue made it; it is then as it was.
Result<void> bring_up_to_date(Database& database, std::span<const std::string_view> steps = schema_steps());

/// Whether the file can be read as it is: the errors of bring_up_to_date(), NotFound where it is still empty,
/// Unsupported where it is older.
Result<void> check_schema(Database& database);

}  // namespace segue::journal::detail
