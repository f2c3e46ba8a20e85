// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/ros2/interface_definition.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::ros2 {

/// Reads the text of a .msg, .srv or .action file, as rosidl_adapter does: one field or constant a line, '#'
/// begins a comment also within quotes. The result are all messages that the interface consists of, its own
/// structure first: of a service also its request, response and event, of an action also the two services and
/// the feedback message that carry it. `file` is named in what is reported; all problems are reported at
/// once, and the result is empty then.
std::vector<MessageDefinition> read_interface(const InterfaceName& name, std::string_view text,
                                              const std::string& file, Diagnostics& diagnostics);

}  // namespace segue::ros2
