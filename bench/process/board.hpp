// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../support/measure.hpp"

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

/// Two processes that measure something together.
namespace bench {

/// How every sample begins, whatever carries it.
struct Stamp {
  std::int64_t sent_ns = 0;
  std::uint64_t number = 0;  ///< from 1; 0 while the connection is tried; kLast: nothing follows
};
constexpr std::uint64_t kLast = ~std::uint64_t{0};

/// Memory that both processes see. The reader notes here what arrives.
struct Board {
  static constexpr std::size_t kMost = 4096;

  std::atomic<std::uint64_t> greeted{0};  ///< arrivals with number 0
  std::atomic<std::uint64_t> arrived{0};  ///< the highest number
  std::atomic<std::uint64_t> lost{0};     ///< numbers that were passed over
  std::atomic<std::int64_t> latency_ns[kMost]{};
  std::atomic<std::int64_t> begin_ns{0};
  std::atomic<std::uint32_t> results{0};
  std::atomic<std::int64_t> result_ns[kMost]{};

  alignas(64) std::atomic<std::uint32_t> word{0};  ///< what the floor hands over by
  Stamp stamp;

  /// For the reader: a sample is there.
  void arrive(const Stamp& sample);
  /// For the writer: something was measured.
  void add_result(Duration duration);
  [[nodiscard]] Summary summary() const;
};

/// One end of a pair.
struct End {
  Board& board;
  int socket;         ///< to the other end; a stream that blocks
  std::size_t bytes;  ///< of a sample
};

struct PairOptions {
  std::size_t bytes = 0;
  std::optional<int> cpu{};  ///< both on that one
  Duration limit = std::chrono::seconds(60);
};

/// Forks two processes from this one, which must have no threads yet, and waits for the writer's end; the
/// reader is ended if it does not end by itself. Answers what they left on the board; nothing where the
/// writer did not end well in time.
std::optional<Summary> run_pair(const PairOptions& options, const std::function<bool(End)>& writer,
                                const std::function<void(End)>& reader);

std::int64_t clock_ns();

}  // namespace bench
