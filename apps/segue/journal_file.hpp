// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/reader.hpp>

#include <filesystem>
#include <string>
#include <vector>

#include "command.hpp"

/// Verbs that read a robot's journal, whether the robot runs or not.
namespace segue::cli {

/// --journal FILE.
Option add_journal_option(Verb& verb, std::string& file);

/// Robots of this user that have a journal where journals are kept, sorted.
std::vector<std::string> robots_with_journals();

/// The given file, or that of the robot, or of the only robot that has one. NotFound where there is none;
/// InvalidArgument where it is not clear which.
Result<std::filesystem::path> find_journal(const std::string& file, const std::string& robot);

}  // namespace segue::cli
