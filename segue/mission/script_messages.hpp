// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// What the engine and the worker script tell each other: JSON, its length in front (4 bytes, little endian).
namespace segue::mission::detail {

/// A message as it is sent. ResourceExhausted beyond `largest` bytes.
Result<std::string> framed(const type::Value& message, std::size_t largest);

/// The text at `key` of a message; empty where there is none.
std::string message_text(const type::Value& message, std::string_view key);

/// Puts messages together from what arrives in pieces.
class MessageReader {
 public:
  explicit MessageReader(std::size_t largest) : largest_(largest) {}
  void append(std::string_view text);
  /// The next whole message; nothing where more must arrive first. ParseError, ResourceExhausted: there is no
  /// going on after either.
  Result<std::optional<type::Value>> next();

 private:
  std::size_t largest_;
  std::string text_;
  std::size_t read_ = 0;
};

/// Puts lines together; what has no end in sight is cut.
class LineReader {
 public:
  void append(std::string_view text);
  /// Without its line end; nothing where more must arrive first.
  std::optional<std::string> next();
  /// What stands behind the last line end.
  std::string rest();

 private:
  std::string text_;
  std::size_t read_ = 0;
};

/// "execute": all that the script sees. InvalidArgument where an input cannot be passed on.
Result<type::Value> execute_message(std::uint64_t id, const std::string& run, Call& call);

/// What a script asked of its global variables, done: the answer's "value", or its "error" and "code".
type::ValueMap answer_about_globals(Globals& globals, const type::Value& request);

}  // namespace segue::mission::detail
