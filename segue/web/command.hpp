// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace segue::web {

inline constexpr std::size_t kLongestCommand = std::size_t{1} << 20;

/// A page's request: {"id": number, "verb": text, "arguments": map}. Functions that take an argument answer
/// InvalidArgument where it is of another kind or missing.
class Command {
 public:
  /// ParseError or InvalidArgument where the text is not a command or longer than kLongestCommand.
  static Result<Command> parse(std::string_view text);

  [[nodiscard]] std::uint64_t id() const { return id_; }
  [[nodiscard]] const std::string& verb() const { return verb_; }

  [[nodiscard]] Result<std::string> text(std::string_view name) const;
  [[nodiscard]] Result<std::string> text_or(std::string_view name, std::string_view otherwise) const;
  [[nodiscard]] Result<bool> flag(std::string_view name) const;  ///< false where it is missing
  [[nodiscard]] Result<std::vector<std::string>> texts(std::string_view name) const;
  [[nodiscard]] Result<std::uint64_t> number_or(std::string_view name, std::uint64_t otherwise) const;
  /// All as they are.
  [[nodiscard]] const type::Value& arguments() const { return arguments_; }
  /// "value" as it is, or "yaml": text in YAML.
  [[nodiscard]] Result<type::Value> value() const;
  /// When to give up: after "timeout_s" seconds, of 600 at most.
  [[nodiscard]] Result<TimePoint> deadline(Duration otherwise) const;
  /// InvalidArgument where there is an argument of another name.
  [[nodiscard]] Result<void> only(const std::vector<std::string>& names) const;

 private:
  std::uint64_t id_ = 0;
  std::string verb_;
  type::Value arguments_;
};

}  // namespace segue::web
