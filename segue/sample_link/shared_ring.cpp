// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/shared_ring.hpp>

#include <bit>

namespace segue::sample_link {

namespace {

using Word = std::atomic<std::uint64_t>;
static_assert(Word::is_always_lock_free && sizeof(Word) == 8, "processes share these words");

constexpr std::size_t kLine = 64;

constexpr std::size_t whole_lines(std::size_t bytes) {
  return (bytes + kLine - 1) / kLine * kLine;
}

/// The offsets of the parts, and the total size.
struct Layout {
  explicit Layout(const Policy& policy)
      : entry_count(policy.size + SharedRing::kExtra + (policy.init ? 1 : 0)),
        returned_count((entry_count + 63) / 64),
        returned(words + whole_lines(WordRing::places(policy.kind, policy.size) * sizeof(Word))),
        entries(returned + whole_lines(returned_count * sizeof(Word))),
        bytes(entries + entry_count * sizeof(RingEntry)) {}

  std::size_t entry_count;
  std::size_t returned_count;
  std::size_t words = whole_lines(sizeof(RingHeader));
  std::size_t returned;
  std::size_t entries;
  std::size_t bytes;
};

}  // namespace

std::size_t SharedRing::bytes(const Policy& policy) {
  return Layout(policy).bytes;
}

SharedRing::SharedRing(std::byte* memory, const Policy& policy, std::uint64_t generation)
    : generation_(generation),
      mark_(generation % ((std::uint64_t{1} << kMarkBits) - 1) + 1),
      header_(reinterpret_cast<RingHeader*>(memory)),
      words_(policy.kind, policy.size, reinterpret_cast<Word*>(memory + Layout(policy).words),
             &header_->head),
      returned_(reinterpret_cast<Word*>(memory + Layout(policy).returned), Layout(policy).returned_count),
      entries_(reinterpret_cast<RingEntry*>(memory + Layout(policy).entries), Layout(policy).entry_count) {}

[[gnu::hot]] std::size_t SharedRing::entry_of(std::uint64_t token) const noexcept {
  const std::uint64_t entry = token & ((std::uint64_t{1} << kEntryBits) - 1);
  return token >> kEntryBits == mark_ && entry < entries_.size() ? entry : entries_.size();
}

[[gnu::hot]] void SharedRing::give_back(std::size_t entry) const noexcept {
  returned_[entry / 64].fetch_or(std::uint64_t{1} << (entry % 64), std::memory_order_acq_rel);  // H3
}

std::size_t SharedRing::count_returned() const noexcept {
  std::size_t count = 0;
  for (const Word& word : returned_)
    count += static_cast<std::size_t>(std::popcount(word.load(std::memory_order_relaxed)));
  return count;
}

Counters SharedRing::counters() const noexcept {
  const auto get = [](const Word& count) { return count.load(std::memory_order_relaxed); };
  return {get(header_->written) + get(header_->initial), get(header_->read), get(header_->dropped),
          get(header_->overwritten)};
}

}  // namespace segue::sample_link
