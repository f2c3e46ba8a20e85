// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace segue::type::detail {

/// A place in a value, such as "properties.range[3].max": a chain on the stack that is spelled out only for
/// messages.
class ValuePath {
 public:
  explicit ValuePath(std::string_view root) : name_(root) {}

  [[nodiscard]] ValuePath field(std::string_view name) const { return {this, name, 0, false}; }
  [[nodiscard]] ValuePath item(std::size_t index) const { return {this, {}, index, true}; }

  [[nodiscard]] std::string text() const {
    std::string text = parent_ == nullptr ? std::string() : parent_->text();
    if (is_item_) return text + "[" + std::to_string(index_) + "]";
    if (!text.empty() && !name_.empty()) text += '.';
    return text.append(name_);
  }

  /// "path: message", or the message alone at a nameless root.
  [[nodiscard]] std::string prefixed(const std::string& message) const {
    const std::string path = text();
    return path.empty() ? message : path + ": " + message;
  }

 private:
  ValuePath(const ValuePath* parent, std::string_view name, std::size_t index, bool is_item)
      : parent_(parent), name_(name), index_(index), is_item_(is_item) {}

  const ValuePath* parent_ = nullptr;
  std::string_view name_;
  std::size_t index_ = 0;
  bool is_item_ = false;
};

}  // namespace segue::type::detail
