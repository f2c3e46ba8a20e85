// SPDX-License-Identifier: Apache-2.0
#include <segue/type/collection.hpp>

#include <cassert>
#include <utility>

namespace segue::type::detail {
namespace {

constexpr std::size_t kLinearSearch = 16;  // entries up to which looking through them beats hashing

}  // namespace

bool Collection::take_key(const std::string& key) {
  if (entries_.size() < kLinearSearch) {
    if (entries_.find(key) != nullptr) return false;
  } else {
    if (keys_.empty()) {
      for (const auto& [known, value] : entries_)
        keys_.insert(known);
    }
    if (!keys_.insert(key).second) return false;
  }
  key_ = key;
  return true;
}

void Collection::add(Value value) {
  assert(!expects_key());
  if (!is_map_) {
    items_.push_back(std::move(value));
    return;
  }
  entries_.append(*std::move(key_), std::move(value));
  key_.reset();
}

Value Collection::finish() {
  Value value = is_map_ ? Value(std::move(entries_)) : Value(std::move(items_));
  value.set_mark(mark_);
  return value;
}

}  // namespace segue::type::detail
