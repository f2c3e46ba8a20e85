// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/journal_reader.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <string>

namespace segue::cli {

/// The events of a robot, in the order in which they happened: missions and their actions, and transitions
/// with "kind": "transition". The latest `limit` of the journal, oldest first, as JSON.
Result<type::Value::List> what_happened(journal::JournalReader& reader, std::size_t limit);

/// One of these as a line without its time: "patrol/there asked for go_to".
std::string happened_line(const type::Value& entry);

}  // namespace segue::cli
