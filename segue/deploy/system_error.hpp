// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <cerrno>
#include <string>
#include <system_error>

namespace segue::deploy::detail {

/// "WHAT: No such file or directory", with the code that fits the system's reason (an errno).
inline Error system_error(const std::string& what, int reason) {
  const auto code = [reason] {
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
  };
  return fail(code(), what + ": " + std::generic_category().message(reason));
}

}  // namespace segue::deploy::detail
