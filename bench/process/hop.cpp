// SPDX-License-Identifier: Apache-2.0
#include "hop.hpp"

#include <sched.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <thread>

namespace bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kRounds = 500;
constexpr std::size_t kBatches = 7;
constexpr std::size_t kLarge = 10'000'000;
constexpr Duration kEnough = seconds(3);  ///< after which no more rounds begin

segue::TimePoint now() {
  return segue::RealClock::instance().now();
}

template <class Done, class Pause>
bool wait_until(const Done& done, const Pause& pause, Duration limit = seconds(20)) {
  const auto deadline = now() + limit;
  while (!done()) {
    if (now() > deadline) return false;
    pause();
  }
  return true;
}

void nap() {
  std::this_thread::sleep_for(std::chrono::microseconds(50));
}

bool send_soon(Writer& writer, std::uint64_t number) {
  return wait_until([&] { return writer.send(number); }, ::sched_yield);
}

/// Sends until the first sample arrives, and with it those in flight.
bool greet(Writer& writer, Board& board) {
  std::uint64_t sent = 0;
  const bool heard = wait_until([&] { return board.greeted.load(std::memory_order_acquire) > 0; },
                                [&] {
                                  if (writer.send(0)) ++sent;
                                  std::this_thread::sleep_for(milliseconds(20));
                                });
  wait_until([&] { return board.greeted.load(std::memory_order_acquire) >= sent; }, nap, milliseconds(500));
  return heard;
}

bool arrives(const Board& board, std::uint64_t number) {
  return wait_until([&] { return board.arrived.load(std::memory_order_acquire) >= number; }, nap);
}

/// "sample 7 has not arrived within 20 s", and what has.
std::string about(std::uint64_t number, const char* what, const Board& board) {
  return "sample " + std::to_string(number) + " " + what + " within 20 s; the last to arrive was " +
         std::to_string(board.arrived.load()) + ", " + std::to_string(board.lost.load()) + " were lost";
}

bool pace(Writer& writer, Board& board) {
  const auto begin = now();
  for (std::uint64_t number = 1; number <= kRounds; ++number) {
    if (number > 5 && now() - begin > kEnough) break;
    std::this_thread::sleep_for(milliseconds(1));
    if (!send_soon(writer, number)) return board.give_up(about(number, "was not accepted", board));
    if (!arrives(board, number)) return board.give_up(about(number, "has not arrived", board));
    if (number > 1) board.add_result(Duration(board.latency_ns[number % Board::kMost].load()));
  }
  const std::uint64_t lost = board.lost.load();
  return lost == 0 || board.give_up(std::to_string(lost) + " samples were lost");
}

bool flood(Writer& writer, Board& board, std::size_t bytes) {
  const std::uint64_t under_way = bytes >= kLarge ? 2 : 8;
  const std::uint64_t batch = bytes >= kLarge ? 5 : bytes >= 1'000'000 ? 100 : 5000;
  std::uint64_t number = 0;
  const auto begin = now();
  for (std::size_t i = 0; i < kBatches && now() - begin < kEnough; ++i) {
    const auto batch_begin = now();
    for (const std::uint64_t last = number + batch; number < last; ++number) {
      const auto room = [&] { return number < board.arrived.load(std::memory_order_acquire) + under_way; };
      if (!wait_until(room, ::sched_yield))
        return board.give_up(about(number - under_way + 1, "has not arrived", board));
      if (!send_soon(writer, number + 1)) return board.give_up(about(number + 1, "was not accepted", board));
    }
    if (!arrives(board, number)) return board.give_up(about(number, "has not arrived", board));
    board.add_result((now() - batch_begin) / static_cast<std::int64_t>(batch));
  }
  return true;
}

using Measure = std::function<bool(Writer&, Board&)>;

segue::Result<Summary> run(Transport& transport, const HopCase& wanted, const Measure& measure) {
  const auto write = [&](const End& end) {
    const auto writer = transport.open(end);
    if (writer == nullptr) return end.board.give_up("the writer cannot be opened");
    if (!greet(*writer, end.board)) return end.board.give_up("no sample has arrived within 20 s");
    const bool done = measure(*writer, end.board);
    send_soon(*writer, kLast);
    std::this_thread::sleep_for(milliseconds(20));
    return done;
  };
  const auto read = [&](const End& end) { transport.read(end); };
  PairOptions options{wanted.bytes, wanted.cpu};
  std::string failure;
  options.failure = &failure;
  const auto summary = run_pair(options, write, read);
  if (summary) return *summary;
  return segue::fail(segue::ErrorCode::Unavailable, failure);
}

}  // namespace

segue::Result<Summary> latency(Transport& transport, const HopCase& wanted) {
  return run(transport, wanted, pace);
}

segue::Result<Summary> throughput(Transport& transport, const HopCase& wanted) {
  return run(transport, wanted,
             [&](Writer& writer, Board& board) { return flood(writer, board, wanted.bytes); });
}

void Comparison::add(Transport& transport) {
  if (!transport.carries(wanted_.bytes)) return;
  const auto summary = experiment_(transport, wanted_);
  if (!summary) {
    table_.note(transport.name(), "failed: " + summary.error().message);
    return;
  }
  if (!floor_) floor_ = *summary;
  table_.add(transport.name(), *summary, 1, floor_->median);
}

void Comparison::print() const {
  table_.print();
  std::fflush(stdout);
}

}  // namespace bench
