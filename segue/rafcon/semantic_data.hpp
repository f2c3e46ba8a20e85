// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The semantic data of states of RAFCON, as the files `semantic_data.json` beside their core_data.json have
/// it.
namespace segue::mission {

/// One change of the semantic data of a state.
struct SemanticEdit {
  std::vector<std::string> keys;     ///< of the entry, the outermost first; at least one
  std::optional<type::Value> value;  ///< nothing: the entry is removed
};

/// The text of a semantic_data.json after the edits, one after the other. Whatever they do not change keeps
/// its bytes; what is new is written as RAFCON writes it (indented by four, keys sorted, ASCII), with the
/// line ends of the text. An empty text is that of a state without such a file. A new entry makes the entries
/// around it. ParseError where the text is not JSON; InvalidArgument where the edit goes into something that
/// has no entries, or has no keys; NotFound where there is nothing to remove. Pure.
Result<std::string> edit_semantic_data(std::string_view text, const std::vector<SemanticEdit>& edits);

}  // namespace segue::mission
