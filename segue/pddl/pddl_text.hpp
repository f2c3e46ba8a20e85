// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::pddl::detail {

/// A word or a list of PDDL, in lower case, with its place.
struct PddlTerm {
  std::string word;  ///< empty: a list
  std::vector<PddlTerm> list;
  SourceLocation where;

  [[nodiscard]] bool is_list() const { return word.empty(); }
  /// A list whose first entry is that word.
  [[nodiscard]] bool begins_with(std::string_view first) const {
    return is_list() && !list.empty() && list.front().word == first;
  }
};

/// The number that a text is, if it has no sign and is not infinite.
std::optional<double> number_in(std::string_view text);

/// Whether the text, after comments and a byte order mark, begins with "(define".
bool begins_with_definition(std::string_view text);

/// All terms of a text; `;` begins a comment, and a byte order mark may precede it. Refuses nesting beyond
/// 200; problems become diagnostics.
std::optional<std::vector<PddlTerm>> parse_pddl(std::string_view text, const std::string& file,
                                                Diagnostics& diagnostics);

/// "a b - t c - (either t u)": names with their types; without any they are of type object. "-t" is "- t".
struct PddlTyped {
  std::string name;
  std::vector<std::string> types;
  SourceLocation where;
};
std::vector<PddlTyped> read_typed_list(const std::vector<PddlTerm>& terms, std::size_t first,
                                       Diagnostics& diagnostics);

}  // namespace segue::pddl::detail
