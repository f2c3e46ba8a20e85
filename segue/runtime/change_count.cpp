// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/change_count.hpp>

#include <utility>

namespace segue::runtime::detail {

void ChangeCount::add() noexcept {
  count_.fetch_add(1, std::memory_order_seq_cst);
  watches_.ring();
}

void ChangeCount::watch(std::uint64_t seen, const Wait& wait,
                        std::function<void(Result<std::uint64_t>)> answered) {
  using End = task_host::detail::Watches::End;
  watches_.add(wait, [this, seen, answered = std::move(answered)](End end) {
    const std::uint64_t now = count_.load(std::memory_order_seq_cst);
    if (end == End::No && now == seen) return false;
    if (end == End::Stop) {
      answered(no_longer_wanted());
    } else if (end == End::Closed) {
      answered(fail(ErrorCode::Unavailable, "the runtime ends"));
    } else {
      answered(now);
    }
    return true;
  });
}

}  // namespace segue::runtime::detail
