// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../support/measure.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

/// Two processes that measure something together.
namespace bench {

/// The header of every sample, on all transports.
struct Stamp {
  std::int64_t sent_ns = 0;
  std::uint64_t number = 0;  ///< from 1; 0 while the connection is tested; kLast: the last sample
};
constexpr std::uint64_t kLast = ~std::uint64_t{0};

/// Memory shared by both processes, in which the reader records arrivals.
struct Board {
  static constexpr std::size_t kMost = 4096;

  std::atomic<std::uint64_t> greeted{0};  ///< arrivals with number 0
  std::atomic<std::uint64_t> arrived{0};  ///< the highest number
  std::atomic<std::uint64_t> lost{0};     ///< skipped numbers
  std::atomic<std::int64_t> latency_ns[kMost]{};
  std::atomic<std::int64_t> begin_ns{0};
  std::atomic<std::uint32_t> results{0};
  std::atomic<std::int64_t> result_ns[kMost]{};

  alignas(64) std::atomic<std::uint32_t> word{0};  ///< the futex of the baseline
  Stamp stamp;
  std::array<char, 200> failure{};  ///< why the writer gave up; empty: it did not

  /// Called by the reader: a sample has arrived.
  void arrive(const Stamp& sample);
  /// Called by the writer: adds a measurement.
  void add_result(Duration duration);
  /// Called by the writer: it gives up. Returns false.
  bool give_up(std::string_view reason);
  [[nodiscard]] Summary summary() const;
};

/// One process of a pair.
struct End {
  Board& board;
  int socket;         ///< to the other process; a blocking stream
  std::size_t bytes;  ///< of a sample
};

struct PairOptions {
  std::size_t bytes = 0;
  std::optional<int> cpu{};  ///< pins both processes to it
  Duration limit = std::chrono::seconds(60);
  std::string* failure = nullptr;  ///< gets the reason where there is no result
};

/// Forks two processes from this one, which must have no threads yet, and waits for the end of the
/// writer; a reader that does not end is killed. Returns the content of the board; nothing if the writer did
/// not end successfully in time.
std::optional<Summary> run_pair(const PairOptions& options, const std::function<bool(End)>& writer,
                                const std::function<void(End)>& reader);

std::int64_t clock_ns();

}  // namespace bench
