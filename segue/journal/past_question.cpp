// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/past_question.hpp>

#include <segue/base/text.hpp>

#include <string>

namespace segue::journal::detail {

using type::Value;

constexpr std::int64_t kMostOfPage = 100;

double seconds(std::int64_t nanoseconds) {
  return static_cast<double>(nanoseconds) / 1e9;
}

Value seconds_or_null(const Statement& row, int column) {
  return row.is_null(column) ? Value() : Value(seconds(row.integer(column)));
}

Error wrong(std::string_view name, std::string_view what) {
  return fail(ErrorCode::InvalidArgument, quote(name) + " " + std::string(what));
}

Result<std::int64_t> whole(const Value& question, std::string_view name, std::int64_t otherwise) {
  const Value* value = question.find(name);
  if (value == nullptr) return otherwise;
  if (!value->is_integer() || (value->kind() == Value::Kind::Int && value->as_int() < 0) ||
      (value->kind() == Value::Kind::UInt && value->as_uint() > (std::uint64_t{1} << 62U)))
    return wrong(name, "must be a non-negative integer");
  return static_cast<std::int64_t>(value->as_uint());
}

Result<Page> page_asked(const Value& question) {
  constexpr std::int64_t kNewest = std::int64_t{1} << 62U;
  const auto before = whole(question, "before", kNewest);
  if (!before) return before.error();
  const auto limit = whole(question, "limit", kMostOfPage);
  if (!limit) return limit.error();
  if (*limit < 1 || *limit > kMostOfPage) return wrong("limit", "must be from 1 to 100");
  return Page{*before, *limit};
}

}  // namespace segue::journal::detail
