// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/database.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <string_view>

/// The parts that questions about the past have in common. For this folder only.
namespace segue::journal::detail {

double seconds(std::int64_t nanoseconds);
type::Value seconds_or_null(const Statement& row, int column);
/// InvalidArgument: what is wrong with that part of a question.
Error wrong(std::string_view name, std::string_view what);
/// A non-negative integer of a question.
Result<std::int64_t> whole(const type::Value& question, std::string_view name, std::int64_t otherwise);

/// The newest entries, or those older than one.
struct Page {
  std::int64_t before = 0;
  std::int64_t limit = 0;
};
/// "before" and "limit", from 1 to 100, of a question.
Result<Page> page_asked(const type::Value& question);

/// Collects the values of all rows of a started statement.
template <class Convert>
Result<type::Value::List> list_of(Statement& rows, Convert convert) {
  type::Value::List list;
  while (true) {
    const auto more = rows.next();
    if (!more) return more.error();
    if (!*more) return list;
    list.push_back(convert(rows));
  }
}

}  // namespace segue::journal::detail
