// SPDX-License-Identifier: Apache-2.0
#include "new_folder.hpp"

#include <segue/base/file.hpp>
#include <segue/base/text.hpp>

#include <cctype>
#include <system_error>

namespace segue::cli {

std::string robot_name_of(const std::filesystem::path& folder) {
  std::string name;
  const auto full = std::filesystem::absolute(folder).lexically_normal();
  for (const char c : (full.has_filename() ? full : full.parent_path()).filename().string()) {
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  return is_identifier(name) ? name : "my_robot";
}

Result<void> check_robot_name(const std::string& name) {
  if (is_identifier(name)) return {};
  return fail(ErrorCode::InvalidArgument,
              quote(name) +
                  " is not a valid robot name; it must begin with a letter, followed by letters, digits, "
                  "'_', '-' or '.'");
}

Result<void> check_new_folder(const std::filesystem::path& folder) {
  std::error_code failed_to;
  if (!std::filesystem::exists(folder, failed_to)) return {};
  if (std::filesystem::is_directory(folder, failed_to) && std::filesystem::is_empty(folder, failed_to))
    return {};
  return fail(
      ErrorCode::AlreadyExists,
      quote(folder.native()) + " exists and is not an empty folder; name one that does not exist yet");
}

Result<void> write_new_folder(const std::filesystem::path& folder, const std::vector<NewFile>& files) {
  for (const NewFile& file : files) {
    const auto path = folder / file.path;
    std::error_code failed_to;
    std::filesystem::create_directories(path.parent_path(), failed_to);
    if (failed_to) {
      return fail(ErrorCode::IoError, "cannot create the folder " + quote(path.parent_path().native()) +
                                          ": " + failed_to.message());
    }
    if (auto written = write_file(path, file.text); !written) return written;
  }
  return {};
}

}  // namespace segue::cli
