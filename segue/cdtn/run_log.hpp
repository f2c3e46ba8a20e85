// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/cdtn/ids.hpp>

#include <cstdint>
#include <string_view>
#include <vector>

namespace segue::cdtn {

/// What happened to a node. Start: with all its resources. End: the run has ended and they are given back.
/// Commit: what it did counts. Skip: it is not on the path. Discard: the result of a run is thrown away.
/// Cancel: a run that goes on is not wanted any more.
enum class LogKind : std::uint8_t { Start, End, Commit, Skip, Discard, Cancel };

struct LogEntry {
  TimePoint when;
  NodeId node{};
  std::uint32_t attempt = 0;
  LogKind kind = LogKind::Start;
};

using RunLog = std::vector<LogEntry>;

}  // namespace segue::cdtn
