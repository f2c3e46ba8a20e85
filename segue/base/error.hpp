// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

/// Errors as values. The vocabulary of `base` lives directly in namespace `segue`, since every folder speaks
/// it.
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
  AlreadyExists,      ///< a second thing of an identity that must be unique
  ParseError,         ///< text that does not follow its format
  TypeMismatch,       ///< data types differ
  InvalidState,       ///< the life cycle does not allow it now
  Unsupported,        ///< known, but not possible here
  PermissionDenied,   ///< the system or a rule forbids it
  ResourceExhausted,  ///< memory, descriptors, pool slots ...
  DeadlineExceeded,   ///< it took too long; the true state must be read again
  Cancelled,          ///< given up on request
  Superseded,         ///< a newer request took its place
  Unavailable,        ///< the peer cannot be reached
  IoError,            ///< the operating system said no
  HookFailed,         ///< a component's hook failed or threw
  Internal            ///< a defect of Segue
};

/// "not-found", "type-mismatch" ...: stable names for tools.
std::string_view to_string(ErrorCode code);

/// One failure: what, where (file or the task or action it concerns), and what caused it.
struct Error {
  ErrorCode code = ErrorCode::Internal;
  std::string message;
  SourceLocation where;
  std::string subject;  ///< id of the task, connection or action; may be empty
  std::shared_ptr<const Error> cause;

  /// This error as the cause of a wider one.
  [[nodiscard]] Error because_of(Error inner) &&;
};

/// One readable line: "where: subject: message (cause)".
std::string to_string(const Error& error);

}  // namespace segue
