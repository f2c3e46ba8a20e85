// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <thread>

namespace segue::task::detail {

/// A short text that one real-time thread at a time sets, without waiting, and any thread reads.
///
/// A sequence lock: version_ is odd while the text changes, and a reader starts over if it has changed. A
/// reader that starts over often sleeps in between, so that it cannot keep a writer of lower priority from
/// finishing.
///
/// Memory order: the text itself is atomic, so there is no data race. X1: the writer stores an odd version_,
/// the text and an even version_; the reader loads version_, the text and version_ again. All is sequentially
/// consistent, since this is not a hot path, so two equal even versions enclose one text.
class RealtimeText {
 public:
  static constexpr std::size_t kBytes = 256;

  void store(std::string_view text) noexcept {
    const std::uint32_t version = version_.load(std::memory_order_relaxed);
    version_.store(version + 1, std::memory_order_seq_cst);  // X1
    const std::size_t size = std::min(text.size(), kBytes);
    for (std::size_t i = 0; i * sizeof(std::uint64_t) < size; ++i) {
      std::uint64_t word = 0;
      std::memcpy(&word, text.data() + i * sizeof word, std::min(sizeof word, size - i * sizeof word));
      words_[i].store(word, std::memory_order_seq_cst);
    }
    size_.store(size, std::memory_order_seq_cst);
    version_.store(version + 2, std::memory_order_seq_cst);  // X1
  }

  [[nodiscard]] std::string load() const {
    constexpr int kTriesAwake = 50;
    for (int tries = 0;; ++tries) {
      if (tries > kTriesAwake) std::this_thread::sleep_for(std::chrono::microseconds(20));
      const std::uint32_t version = version_.load(std::memory_order_seq_cst);  // X1
      if (version % 2 == 1) continue;
      std::array<std::uint64_t, kBytes / sizeof(std::uint64_t)> words{};
      const std::size_t size = size_.load(std::memory_order_seq_cst);
      for (std::size_t i = 0; i * sizeof(std::uint64_t) < size; ++i) {
        words[i] = words_[i].load(std::memory_order_seq_cst);
      }
      if (version_.load(std::memory_order_seq_cst) != version) continue;  // X1
      std::string text(size, '\0');
      std::memcpy(text.data(), words.data(), size);
      return text;
    }
  }

 private:
  std::atomic<std::uint32_t> version_{0};
  std::atomic<std::size_t> size_{0};
  std::array<std::atomic<std::uint64_t>, kBytes / sizeof(std::uint64_t)> words_{};
};

}  // namespace segue::task::detail
