// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/node_command.hpp>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <utility>

namespace segue::ros2 {
namespace {

/// PREFIX/lib/PACKAGE/EXECUTABLE
std::optional<NodeCommand> of_program(const std::filesystem::path& program) {
  const auto package = program.parent_path();
  const auto lib = package.parent_path();
  if (!program.is_absolute() || lib.filename() != "lib" || package.filename().empty()) return {};
  return NodeCommand{lib.parent_path().string(), package.filename().string(), program.filename().string()};
}

void add_remapping(std::string_view rule, NodeCommand& command) {
  const std::size_t to = rule.find(":=");
  if (to == std::string_view::npos) return;
  const std::string_view from = rule.substr(0, to);
  const std::string_view what = from.substr(std::min(from.size(), from.find(':') + 1));  // of "node:from"
  if (what != "__node" && what != "__name" && what != "__ns") command.remappings.emplace_back(rule);
}

}  // namespace

std::optional<NodeCommand> parse_node_command(const std::vector<std::string>& words) {
  std::optional<NodeCommand> command;
  std::size_t next = 0;
  // A node in Python is the second word.
  for (; next < std::min<std::size_t>(words.size(), 2) && !command; ++next)
    command = of_program(words[next]);
  if (!command) return {};
  bool is_for_ros = false;
  for (; next < words.size(); ++next) {
    const std::string& word = words[next];
    if (word == "--ros-args") {
      is_for_ros = true;
    } else if (is_for_ros && word == "--") {
      is_for_ros = false;
    } else if (!is_for_ros) {
      command->arguments.push_back(word);
    } else if ((word == "-r" || word == "--remap") && next + 1 < words.size()) {
      add_remapping(words[++next], *command);
    }
  }
  return command;
}

}  // namespace segue::ros2
