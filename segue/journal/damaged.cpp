// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/journal/damaged.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <system_error>
#include <vector>

namespace segue::journal::detail {

namespace {

constexpr std::size_t kKept = 5;
constexpr std::array<std::string_view, 3> kParts = {"", "-wal", "-shm"};

/// N of every "NAME.broken-N" in the folder of the file, in increasing order.
std::vector<int> numbers_of(const std::filesystem::path& path) {
  const std::string prefix = path.filename().native() + ".broken-";
  std::vector<int> numbers;
  std::error_code failed;
  for (std::filesystem::directory_iterator entry(path.parent_path(), failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string name = entry->path().filename().native();
    if (!name.starts_with(prefix)) continue;
    int number = 0;
    const char* const last = name.data() + name.size();
    const auto [rest, error] = std::from_chars(name.data() + prefix.size(), last, number);
    if (error == std::errc() && rest == last && number > 0) numbers.push_back(number);
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

std::filesystem::path broken_name(const std::filesystem::path& path, int number) {
  return path.native() + ".broken-" + std::to_string(number);
}

}  // namespace

Result<std::filesystem::path> move_aside(const std::filesystem::path& path) {
  const auto numbers = numbers_of(path);
  const auto name = broken_name(path, numbers.empty() ? 1 : numbers.back() + 1);
  std::error_code failed;
  std::filesystem::rename(path, name, failed);
  if (failed) {
    return fail(ErrorCode::PermissionDenied,
                "cannot move the damaged " + quote(path.native()) + " aside: " + failed.message());
  }
  for (const std::string_view part : kParts) {
    if (!part.empty())
      std::filesystem::rename(path.native() + std::string(part), name.native() + std::string(part), failed);
  }
  for (std::size_t i = 0; i + kKept <= numbers.size(); ++i) {
    for (const std::string_view part : kParts)
      std::filesystem::remove(broken_name(path, numbers[i]).native() + std::string(part), failed);
  }
  return name;
}

}  // namespace segue::journal::detail
