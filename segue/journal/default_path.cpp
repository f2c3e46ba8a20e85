// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/journal/journal.hpp>

#include <cstdlib>

namespace segue::journal {

namespace {

/// A relative path in such a variable is to be ignored (XDG Base Directory Specification).
std::filesystem::path folder_in(const char* variable) {
  const char* value = std::getenv(variable);
  const std::filesystem::path folder = value == nullptr ? "" : value;
  return folder.is_absolute() ? folder : std::filesystem::path();
}

}  // namespace

Result<std::filesystem::path> default_path(std::string_view robot) {
  if (!is_identifier(robot)) return fail(ErrorCode::InvalidArgument, quote(robot) + " is no robot's name");
  std::filesystem::path state = folder_in("XDG_STATE_HOME");
  if (state.empty()) {
    const auto home = folder_in("HOME");
    if (home.empty()) {
      return fail(ErrorCode::NotFound, "there is no place for the journal of " + quote(robot) +
                                           ": neither XDG_STATE_HOME nor HOME names a folder");
    }
    state = home / ".local" / "state";
  }
  return state / "segue" / robot / "journal.sqlite";
}

}  // namespace segue::journal
