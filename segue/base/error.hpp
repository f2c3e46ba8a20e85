// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

/// Errors as values. Names of `base` live directly in namespace `segue`, since every folder uses them.
namespace segue {

/// A place in a file. Lines and columns count from 1; 0 means unknown.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;

  friend bool operator==(const SourceLocation&, const SourceLocation&) = default;
  [[nodiscard]] bool known() const { return !file.empty() || line > 0; }
};

/// "file:12:14", "file" or "" as far as known.
std::string to_string(const SourceLocation& where);

enum class ErrorCode {
  InvalidArgument,    ///< the caller's value is wrong
  NotFound,           ///< no such file, task, port, component ...
  AlreadyExists,      ///< the name or identity is taken
  ParseError,         ///< text that violates its format
  TypeMismatch,       ///< data types differ
  InvalidState,       ///< the life cycle does not allow it now
  Unsupported,        ///< recognised, but not possible here
  PermissionDenied,   ///< the system or a rule forbids it
  ResourceExhausted,  ///< memory, descriptors, pool slots ...
  DeadlineExceeded,   ///< it took too long; its outcome is unknown until the state is read again
  Cancelled,          ///< cancelled on request
  Superseded,         ///< replaced by a newer request
  Unavailable,        ///< the peer cannot be reached
  IoError,            ///< the operating system reported a failure
  HookFailed,         ///< a component's hook failed or threw
  Internal            ///< a defect in Segue
};

/// "not-found", "type-mismatch" ...: stable names for tools.
std::string_view to_string(ErrorCode code);

class Diagnostics;

/// One failure: its message, the place in a file or the task or action that it concerns, and its cause.
struct Error {
  ErrorCode code = ErrorCode::Internal;
  std::string message;
  SourceLocation where;
  std::string subject;  ///< id of the task, connection or action; may be empty
  std::shared_ptr<const Error> cause;
  /// All that was found in the files that were read, of which the message names the first error; null where
  /// no file was read. See diagnostics_of().
  std::shared_ptr<const Diagnostics> diagnostics{};

  /// This error with `inner` as its cause.
  [[nodiscard]] Error because_of(Error inner) &&;
  /// This error, about `what` where it does not say what it is about.
  [[nodiscard]] Error about(std::string what) &&;
};

/// One readable line: "where: subject: message (cause)".
std::string to_string(const Error& error);

/// "WHAT: No such file or directory", with the code that fits the system's reason (an errno). Any thread.
Error system_error(const std::string& what, int reason);

}  // namespace segue
