// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/database.hpp>

#include <filesystem>
#include <span>
#include <string_view>

/// The tables of a journal, and the migration of older files.
namespace segue::journal::detail {

/// Step i migrates a file from version i to version i + 1; the first step creates all tables in an empty
/// file. Released steps are never changed: a new version adds a step.
std::span<const std::string_view> schema_steps();

/// Creates or migrates the tables in one transaction. InvalidArgument if the file belongs to another program,
/// Unsupported if a newer Segue created it; the file is then unchanged.
Result<void> bring_up_to_date(Database& database, std::span<const std::string_view> steps = schema_steps());

/// Opens the file, which is created with its folder if it is missing, brings its tables up to date, and has
/// what is committed on the disk. Fails like Database::open() and bring_up_to_date().
Result<Database> open_with_tables(const std::filesystem::path& path,
                                  std::span<const std::string_view> steps = schema_steps());

/// Whether the file can be read as it is. Fails like bring_up_to_date(), with NotFound if the file is empty,
/// and with Unsupported if it is older.
Result<void> check_schema(Database& database);

}  // namespace segue::journal::detail
