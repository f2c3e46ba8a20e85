// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/base/text.hpp>
#include <segue/type/describe.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <string>

namespace segue::task {

/// What a task remembers, for the one that continues its work. A plain value: it travels between processes
/// and computers.
struct State {
  std::string name;           ///< what it is, usually its type's name: "/demo/FilterState"
  std::uint32_t version = 1;  ///< counted up when its meaning changes
  type::Value value;
  friend bool operator==(const State&, const State&) = default;
};

/// A described value as a state that has its type's name.
template <class T>
State make_state(const T& value, std::uint32_t version = 1) {
  const type::TypeInfo& info = type::type_info<T>();
  return {std::string(info.name()), version, info.to_value(&value)};
}

/// The value of a state of that type and version. Fails (TypeMismatch) for every other state, and says what
/// it is.
template <class T>
Result<T> read_state(const State& state, std::uint32_t version = 1) {
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
