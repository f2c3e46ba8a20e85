// SPDX-License-Identifier: Apache-2.0
#include <segue/web/command.hpp>

#include <cstddef>
#include <cstdint>
#include <string_view>

/// Whatever a browser sends is a command or an error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto command = segue::web::Command::parse({reinterpret_cast<const char*>(data), size});
  if (!command) return 0;
  for (const char* name : {"task", "value", "yaml", "controllers"}) {
    (void)command->text(name);
    (void)command->flag(name);
    (void)command->texts(name);
    (void)command->number_or(name, 0);
  }
  (void)command->value();
  (void)command->deadline({});
  (void)command->only({"task", "value"});
  return 0;
}
