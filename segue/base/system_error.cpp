// SPDX-License-Identifier: Apache-2.0
#include <segue/base/system_error.hpp>

#include <cerrno>
#include <system_error>

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

Error system_error(const std::string& what, int reason) {
  return fail(code_of(reason), what + ": " + std::generic_category().message(reason));
}

}  // namespace segue
