// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/journal_reader.hpp>

#include <filesystem>
#include <string>
#include <vector>

#include "command.hpp"

/// For verbs that read the journal of a robot, whether or not it is running.
namespace segue::cli {

/// --journal FILE.
Option add_journal_option(Verb& verb, std::string& file);

/// Robots of this user that have a journal where journals are kept, sorted.
std::vector<std::string> robots_with_journals();

/// The given file, the journal of the robot, or that of the only robot that has one. NotFound if there is
/// none; InvalidArgument if it is ambiguous.
Result<std::filesystem::path> find_journal(const std::string& file, const std::string& robot);

}  // namespace segue::cli
