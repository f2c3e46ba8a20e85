// SPDX-License-Identifier: Apache-2.0
#include <segue/process_server/launch.hpp>
#include <segue/type/json.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

/// Whatever is handed to a deployment process is refused with a reason, or is a launch that reads back equal.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto value = segue::type::parse_json({reinterpret_cast<const char*>(data), size}, "launch");
  if (!value) return 0;
  const auto launch = segue::process_server::launch_from(*value);
  if (!launch) {
    if (launch.error().message.empty()) std::abort();
    return 0;
  }
  const auto again = segue::process_server::launch_from(segue::process_server::to_value(*launch));
  if (!again || !(*again == *launch)) std::abort();
  return 0;
}
