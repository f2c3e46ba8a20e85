// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/type/value.hpp>

#include <gtest/gtest.h>

#include <string>
#include <string_view>

/// Expected diagnostics of text cases: a list of "6:5 error unknown-task: did you mean 'b'". The part after
/// the first ": " must be contained in the message, and is optional.
namespace segue::testing {

/// "6:5 error unknown-task", preceded by the file's name unless that is `own`.
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

/// The diagnostics in the form of a case.
inline std::string all(const Diagnostics& diagnostics, std::string_view own) {
  std::string text;
  for (const Diagnostic& item : diagnostics.items())
    text += "  - \"" + head(item, own) + ": " + item.message + "\"\n";
  return text;
}

/// Expects exactly these, in this order.
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
