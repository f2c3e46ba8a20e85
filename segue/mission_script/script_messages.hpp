// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission_script/script_objects.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

/// Messages between the engine and the worker script: JSON with a length prefix (4 bytes, little endian).
namespace segue::mission::detail {

/// A message with its length prefix. ResourceExhausted if it has more than `largest` bytes.
Result<std::string> framed(const type::Value& message, std::size_t largest);

/// Assembles messages from the pieces that arrive.
class MessageReader {
 public:
  explicit MessageReader(std::size_t largest) : largest_(largest) {}
  void append(std::string_view text);
  /// The next complete message; nothing if more data must arrive first. ParseError, ResourceExhausted: after
  /// either the stream is unusable.
  Result<std::optional<type::Value>> next();

 private:
  std::size_t largest_;
  std::string text_;
  std::size_t read_ = 0;
};

/// Assembles lines; lines that are too long are split.
class LineReader {
 public:
  void append(std::string_view text);
  /// The next line without its line end; nothing if more data must arrive first.
  std::optional<std::string> next();
  /// The text after the last line end.
  std::string rest();

 private:
  std::string text_;
  std::size_t read_ = 0;
};

/// The path of the state; of the mission itself, its name.
std::string path_of(const ActionCall& call);

/// The message "execute", with everything that the script sees. InvalidArgument if an input cannot be passed
/// to a script. `has_robot`: the run has one. `world`: that the script may read; null: none.
Result<type::Value> execute_message(std::uint64_t id, const std::string& run, ActionCall& call,
                                    bool has_robot, const WorldView* world);

/// Carries out a request of a script about global variables: returns "value", and "objects" where variables
/// hold objects of its process, the numbers by the variables' names; or "error" and "code".
type::ValueMap answer_about_globals(Globals& globals, const std::shared_ptr<ScriptObjects>& objects,
                                    const type::Value& request);

}  // namespace segue::mission::detail
