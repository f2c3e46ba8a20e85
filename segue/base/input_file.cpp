// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/input_file.hpp>
#include <segue/base/text.hpp>

#include <cstdlib>

namespace segue {

Result<std::string> read_input_file(const std::filesystem::path& path) {
  Result<std::uint64_t> limit = std::uint64_t{16} << 20;
  if (const char* chosen = std::getenv(kLargestInput); chosen != nullptr && *chosen != '\0')
    limit = parse_size(chosen);
  if (!limit) {
    limit.error().message = std::string(kLargestInput) + ": " + limit.error().message;
    return limit.error();
  }
  auto text = read_file(path, *limit);
  if (text || text.error().code != ErrorCode::ResourceExhausted) return text;
  return fail(ErrorCode::ResourceExhausted, quote(path.string()) + " is larger than " + format_size(*limit) +
                                                "; to read it, set the environment variable " +
                                                kLargestInput + ", such as to 100MB");
}

}  // namespace segue
