// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/symbol.hpp>

#include <algorithm>

namespace segue::convert {

Defaults with(const Defaults& defaults, Default more) {
  const bool certain = defaults && std::ranges::any_of(*defaults, [](const Default& one) {
                         return index(one.reader) == task_network::kNone && !one.value.is_null();
                       });
  if (certain) return defaults;
  const bool nothing = index(more.reader) == task_network::kNone && more.value.is_null();
  if (nothing && defaults) return defaults;
  static const Defaults kNothing = std::make_shared<const std::vector<Default>>();
  if (nothing) return kNothing;
  auto extended =
      defaults ? std::make_shared<std::vector<Default>>(*defaults) : std::make_shared<std::vector<Default>>();
  extended->push_back(std::move(more));
  return extended;
}

/// Removes earlier writes that the new value always replaces, and writes that are off the path.
void Slots::write(std::uint32_t slot, BranchEdge when, Symbol value, PathConditions& paths) {
  auto& writes = slots_[slot];
  std::erase_if(writes, [&](Write& old) {
    const auto live = paths.live(old.when);
    if (!live) return true;
    old.when = *live;
    return paths.implies(old.when, when);
  });
  writes.push_back({++turn_, when, std::move(value)});
}

/// Adds a write; called with the newest first. False if no older write counts.
bool Slots::Reader::take(const Write& write) {
  const auto when = paths.live(write.when);
  if (!when || paths.exclude(*when, at)) return true;
  const auto& candidates = write.value.candidates;
  for (auto candidate = candidates.rbegin(); candidate != candidates.rend(); ++candidate) {
    const auto live = paths.live(candidate->when);
    if (!live || paths.exclude(*live, at)) continue;
    result.candidates.push_back({candidate->node, candidate->output, *live, candidate->defaults, write.turn});
  }
  const bool last = planted(ConversionFault::ForgetsOldWrites) && !write.value.candidates.empty();
  if (!paths.implies(at, *when) && !last) return true;
  result.rest = write.value.rest;
  result.rest_turn = write.turn;
  return false;
}

Symbol Slots::read(std::uint32_t slot, BranchEdge at, PathConditions& paths) const {
  Reader reader{at, paths, {}};
  const auto& writes = slots_[slot];  // in the order of writing
  if (planted(ConversionFault::TakesOldestWrite)) {
    for (auto write = writes.begin(); write != writes.end() && reader.take(*write);)
      ++write;
  } else {
    for (auto write = writes.rbegin(); write != writes.rend() && reader.take(*write);)
      ++write;
  }
  std::ranges::reverse(reader.result.candidates);
  return std::move(reader.result);
}

}  // namespace segue::convert
