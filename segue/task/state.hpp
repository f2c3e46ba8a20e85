// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/base/text.hpp>
#include <segue/task/saved_state.hpp>
#include <segue/type/describe.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <string>

namespace segue::task {

/// A described value as a state with the name of its type.
template <class T>
SavedState make_state(const T& value, std::uint32_t version = 1) {
  const type::TypeInfo& info = type::type_info<T>();
  return {std::string(info.name()), version, info.to_value(&value)};
}

/// The value of a state of type T and this version. TypeMismatch, naming both, for every other state.
template <class T>
Result<T> read_state(const SavedState& state, std::uint32_t version = 1) {
  const type::TypeInfo& info = type::type_info<T>();
  if (state.name != info.name() || state.version != version) {
    return fail(ErrorCode::TypeMismatch, "expected " + quote(info.name()) + " version " +
                                             std::to_string(version) + ", got " + quote(state.name) +
                                             " version " + std::to_string(state.version));
  }
  T value{};
  if (auto read = info.from_value(&value, state.value, "state"); !read) return std::move(read.error());
  return value;
}

}  // namespace segue::task
