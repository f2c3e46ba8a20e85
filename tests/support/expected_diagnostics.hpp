// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/type/value.hpp>

#include <gtest/gtest.h>

#include <string>
#include <string_view>

/// Diagnostics as text cases expect them: a list of "6:5 error unknown-task: did you mean 'b'", where what
/// follows the first ": " must be part of the message, and may be left out.
namespace segue::testing {

/// "6:5 error unknown-task", with the file's name first where it is not the case's `own`.
inline std::string head(const Diagnostic& diagnostic, std::string_view own) {
  const SourceLocation& where = diagnostic.where;
  const bool plain = where.file.empty() || (where.file == own && where.line > 0);
  const std::string at =
      plain ? std::to_string(where.line) + ":" + std::to_string(where.column) : to_string(where);
  return at + " " + std::string(to_string(diagnostic.severity)) + " " + diagnostic.code;
}

inline bool fits(const Diagnostic& diagnostic, const std::string& expected, std::string_view own) {
  const auto colon = expected.find(": ");
  if (expected.substr(0, colon) != head(diagnostic, own)) return false;
  return colon == std::string::npos ||
         diagnostic.message.find(expected.substr(colon + 2)) != std::string::npos;
}

/// As they would stand in a case.
inline std::string all(const Diagnostics& diagnostics, std::string_view own) {
  std::string text;
  for (const Diagnostic& item : diagnostics.items())
    text += "  - \"" + head(item, own) + ": " + item.message + "\"\n";
  return text;
}

/// Exactly these, in this order.
inline void expect_diagnostics(const Diagnostics& found, const type::Value* expect,
                               std::string_view own = {}) {
  ASSERT_TRUE(expect != nullptr && expect->is_list()) << "a case needs a list 'expect'";
  ASSERT_EQ(found.items().size(), expect->as_list().size()) << "found:\n" << all(found, own);
  for (std::size_t i = 0; i < found.items().size(); ++i) {
    const std::string& expected = expect->as_list()[i].as_string();
    EXPECT_TRUE(fits(found.items()[i], expected, own)) << "expected: " << expected << "\nfound:\n"
                                                       << all(found, own);
  }
}

}  // namespace segue::testing
