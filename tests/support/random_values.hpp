// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <rapidcheck.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

/// rapidcheck generators of dynamic values, for tests only.
namespace segue::type {

/// Valid UTF-8 text that is difficult to write: quotes, line breaks, blanks, numbers, indicators of YAML.
inline rc::Gen<std::string> random_text() {
  static const std::vector<std::string> kPieces = {"a",
                                                   "b",
                                                   "Pose",
                                                   "0",
                                                   "1",
                                                   "7",
                                                   ".",
                                                   "-",
                                                   "+",
                                                   "e",
                                                   "x",
                                                   "true",
                                                   "null",
                                                   "~",
                                                   " ",
                                                   "  ",
                                                   "\n",
                                                   "\t",
                                                   "\r",
                                                   "'",
                                                   "\"",
                                                   "\\",
                                                   ":",
                                                   ": ",
                                                   " #",
                                                   "#",
                                                   "- ",
                                                   "[",
                                                   "]",
                                                   "{",
                                                   "}",
                                                   ",",
                                                   "&",
                                                   "*",
                                                   "!",
                                                   "|",
                                                   ">",
                                                   "%",
                                                   "@",
                                                   "`",
                                                   "?",
                                                   "<<",
                                                   "no",
                                                   ".inf",
                                                   "---",
                                                   "=",
                                                   "\x01",
                                                   "\x7f",
                                                   "/",
                                                   "::",
                                                   "\xC3\xA9",
                                                   "\xE2\x80\xA8",
                                                   "\xF0\x9F\xA4\x96",
                                                   "\xEF\xBB\xBF",
                                                   "\xC2\x85"};
  return rc::gen::exec([] {
    std::string text;
    for (const std::size_t piece :
         *rc::gen::container<std::vector<std::size_t>>(rc::gen::inRange<std::size_t>(0, kPieces.size()))) {
      text += kPieces.at(piece);
    }
    if (*rc::gen::weightedElement<bool>({{19, false}, {1, true}})) text.push_back('\0');
    return text;
  });
}

inline rc::Gen<double> random_double() {
  return rc::gen::oneOf(
      rc::gen::arbitrary<double>(),
      rc::gen::map(rc::gen::inRange(-1000, 1000), [](int tenths) { return tenths / 10.0; }),
      rc::gen::element(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                       std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::denorm_min(),
                       std::numeric_limits<double>::max(), -0.0, 1e20, 1e-7));
}

inline rc::Gen<Value> random_scalar() {
  return rc::gen::oneOf(
      rc::gen::just(Value()), rc::gen::map(rc::gen::arbitrary<bool>(), [](bool b) { return Value(b); }),
      rc::gen::map(rc::gen::arbitrary<std::int64_t>(), [](std::int64_t i) { return Value(i); }),
      rc::gen::map(rc::gen::arbitrary<std::uint64_t>(), [](std::uint64_t i) { return Value(i); }),
      rc::gen::map(random_double(), [](double d) { return Value(d); }),
      rc::gen::map(random_text(), [](std::string text) { return Value(std::move(text)); }));
}

/// Trees up to `levels` deep.
inline rc::Gen<Value> random_value(int levels = 4) {
  if (levels == 0) return random_scalar();
  return rc::gen::exec([levels] {
    const int kind = *rc::gen::inRange(0, 5);
    if (kind < 2) return *random_scalar();
    const int count = *rc::gen::inRange(0, 6);
    if (kind == 2) {
      Value::List list;
      for (int i = 0; i < count; ++i)
        list.push_back(*random_value(levels - 1));
      return Value(std::move(list));
    }
    ValueMap map;
    for (int i = 0; i < count; ++i)
      map.set(*random_text(), *random_value(levels - 1));
    return Value(std::move(map));
  });
}

}  // namespace segue::type
