// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/error.hpp>
#include <segue/base/result.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace segue {

enum class Severity {
  Hint,     ///< advice
  Warning,  ///< probably a mistake
  Error     ///< cannot be used
};

std::string_view to_string(Severity severity);

/// One finding about a file: `code` is a stable kebab-case name ("unknown-port"); `message` says what is
/// wrong, where in the data, and what to do next.
struct Diagnostic {
  Severity severity = Severity::Error;
  std::string code;
  std::string message;
  SourceLocation where;

  friend bool operator==(const Diagnostic&, const Diagnostic&) = default;
};

/// "file:12:14: error: message [code]"
std::string to_string(const Diagnostic& diagnostic);

/// All findings of one reading or validation. Not thread safe.
class Diagnostics {
 public:
  void error(std::string code, std::string message, SourceLocation where = {});
  void warning(std::string code, std::string message, SourceLocation where = {});
  void add(Diagnostic diagnostic);
  void append(const Diagnostics& other);

  [[nodiscard]] bool has_errors() const { return errors_ > 0; }
  [[nodiscard]] std::size_t error_count() const { return errors_; }
  [[nodiscard]] bool empty() const { return items_.empty(); }
  [[nodiscard]] const std::vector<Diagnostic>& items() const { return items_; }

  /// Sorts by file, line and column; findings without a place come last.
  void sort();

  /// The first error, with the number of further ones in its message; it carries all that was found.
  /// Requires has_errors().
  [[nodiscard]] Error to_error(ErrorCode code = ErrorCode::InvalidArgument) const;

 private:
  std::vector<Diagnostic> items_;
  std::size_t errors_ = 0;
};

/// One diagnostic a line.
std::string to_string(const Diagnostics& diagnostics);

/// The diagnostics that the error carries; else the error itself as the only one, whose code is that of the
/// error.
[[nodiscard]] Diagnostics diagnostics_of(const Error& error);

}  // namespace segue
