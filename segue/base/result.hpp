// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/error.hpp>

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace segue {

/// A value, or the Error that prevented it. Must not be ignored.
/// This is the only header that names the library behind it (gcc 12 has no std::expected).
template <class T = void>
class [[nodiscard]] Result : public tl::expected<T, Error> {
  using Base = tl::expected<T, Error>;

 public:
  using Base::Base;
  Result() = default;
  Result(Base base) : Base(std::move(base)) {}                   // NOLINT(google-explicit-constructor)
  Result(Error error) : Base(tl::unexpect, std::move(error)) {}  // NOLINT(google-explicit-constructor)
};

/// An Error in one expression: `return fail(ErrorCode::NotFound, "no task 'x'");`
inline Error fail(ErrorCode code, std::string message, std::string subject = {}, SourceLocation where = {}) {
  return Error{code, std::move(message), std::move(where), std::move(subject), nullptr};
}

}  // namespace segue
