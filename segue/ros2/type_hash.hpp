// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/ros2/interface_library.hpp>

#include <span>
#include <string>
#include <string_view>

namespace segue::ros2 {

/// The type description of an interface as canonical JSON (REP-2011, REP-2016): keys in the order of
/// type_description_interfaces/msg/TypeDescription, referenced types sorted by name, without default values.
Result<std::string> type_description(InterfaceLibrary& library, std::string_view name);

/// "RIHS01_" and the SHA-256 of the type description, in hexadecimal: by it, nodes from Iron on tell whether
/// they mean the same interface.
Result<std::string> type_hash(InterfaceLibrary& library, std::string_view name);
/// Of a message and its parts, as InterfaceLibrary::with_parts() returns them.
std::string type_hash(std::span<const MessageDefinition* const> messages);

}  // namespace segue::ros2
