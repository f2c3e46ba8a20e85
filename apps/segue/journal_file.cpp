// SPDX-License-Identifier: Apache-2.0
#include "journal_file.hpp"

#include <segue/base/text.hpp>
#include <segue/journal/journal.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <system_error>

namespace segue::cli {

Option add_journal_option(Verb& verb, std::string& file) {
  return verb.option("--journal FILE", file, "use this journal file instead of the robot's own");
}

std::vector<std::string> robots_with_journals() {
  std::vector<std::string> robots;
  const auto any = journal::default_path("any");
  if (!any) return robots;
  std::error_code failed;
  const auto home = any->parent_path().parent_path();
  for (std::filesystem::directory_iterator entry(home, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    std::error_code ignored;
    if (std::filesystem::exists(entry->path() / any->filename(), ignored)) {
      robots.push_back(entry->path().filename().native());
    }
  }
  std::sort(robots.begin(), robots.end());
  return robots;
}

Result<std::filesystem::path> find_journal(const std::string& file, const std::string& robot) {
  if (!file.empty()) return std::filesystem::path(file);
  if (!robot.empty()) return journal::default_path(robot);
  const auto robots = robots_with_journals();
  if (robots.size() == 1) return journal::default_path(robots.front());
  if (robots.empty()) {
    return fail(ErrorCode::NotFound, "no robot has a journal yet; `segue run ROBOT_FILE` creates one");
  }
  return fail(ErrorCode::InvalidArgument,
              fmt::format("{} robots have a journal: {}; say which with --robot NAME", robots.size(),
                          listed(robots)));
}

}  // namespace segue::cli
