// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace segue {

/// A name with a type of its own, so that kinds of names cannot be confused: `using TaskId = Id<struct
/// TaskIdTag>`.
template <class Tag>
class Id {
 public:
  Id() = default;
  explicit Id(std::string name) : name_(std::move(name)) {}
  explicit Id(std::string_view name) : name_(name) {}
  explicit Id(const char* name) : name_(name) {}

  [[nodiscard]] const std::string& str() const { return name_; }
  [[nodiscard]] bool empty() const { return name_.empty(); }

  friend bool operator==(const Id&, const Id&) = default;
  friend auto operator<=>(const Id&, const Id&) = default;

 private:
  std::string name_;
};

template <class Tag>
const std::string& to_string(const Id<Tag>& id) {
  return id.str();
}

}  // namespace segue

template <class Tag>
struct std::hash<segue::Id<Tag>> {
  std::size_t operator()(const segue::Id<Tag>& id) const noexcept {
    return std::hash<std::string>{}(id.str());
  }
};
