// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>

#include <array>
#include <cstdint>

namespace fault {

/// A numbered sample of which every part repeats the number: a torn one shows. `incarnation` is the writer's
/// object, so a restart shows too.
struct Beat {
  std::uint64_t number = 0;
  std::uint64_t incarnation = 0;
  std::array<std::uint64_t, 64> echo{};
};

/// The observations of a watcher since its creation.
struct Report {
  std::uint64_t beats = 0;
  std::uint64_t words = 0;  ///< samples of text
  std::uint64_t last = 0;   ///< the newest number
  std::uint64_t gaps = 0;   ///< numbers that never came
  std::uint64_t restarts = 0;
  std::uint64_t torn = 0;
  std::uint64_t starts = 0;  ///< of the watcher itself
};

SEGUE_TYPE(Beat, number, incarnation, echo)
SEGUE_TYPE(Report, beats, words, last, gaps, restarts, torn, starts)

}  // namespace fault
