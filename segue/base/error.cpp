// SPDX-License-Identifier: Apache-2.0
#include <segue/base/error.hpp>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

namespace segue {

namespace {

ErrorCode code_of(int reason) {
  switch (reason) {
    case EACCES:
    case EPERM:
      return ErrorCode::PermissionDenied;
    case ENOENT:
      return ErrorCode::NotFound;
    case EMFILE:
    case ENFILE:
    case ENOMEM:
    case EAGAIN:
    case ENOSPC:
      return ErrorCode::ResourceExhausted;
    default:
      return ErrorCode::IoError;
  }
}

}  // namespace

std::string to_string(const SourceLocation& where) {
  std::string text = where.file;
  if (where.line <= 0) return text;
  if (!text.empty()) text += ':';
  text += std::to_string(where.line);
  if (where.column > 0) text += ':' + std::to_string(where.column);
  return text;
}

std::string_view to_string(ErrorCode code) {
  static constexpr std::array<std::string_view, 16> kNames = {
      "invalid-argument",   "not-found",         "already-exists", "parse-error",
      "type-mismatch",      "invalid-state",     "unsupported",    "permission-denied",
      "resource-exhausted", "deadline-exceeded", "cancelled",      "superseded",
      "unavailable",        "io-error",          "hook-failed",    "internal"};
  return kNames.at(static_cast<std::size_t>(code));
}

Error Error::because_of(Error inner) && {
  cause = std::make_shared<const Error>(std::move(inner));
  return std::move(*this);
}

Error Error::about(std::string what) && {
  if (subject.empty()) subject = std::move(what);
  return std::move(*this);
}

std::string to_string(const Error& error) {
  std::string text;
  if (error.where.known()) text += to_string(error.where) + ": ";
  if (!error.subject.empty()) text += error.subject + ": ";
  text += error.message;
  if (error.cause) text += " (" + to_string(*error.cause) + ")";
  return text;
}

Error system_error(const std::string& what, int reason) {
  return Error{code_of(reason), what + ": " + std::generic_category().message(reason), {}, {}, nullptr};
}

}  // namespace segue
