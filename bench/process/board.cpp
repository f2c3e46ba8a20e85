// SPDX-License-Identifier: Apache-2.0
#include "board.hpp"

#include "../support/floor.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>
#include <thread>

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace bench {
namespace {

struct Unmap {
  void operator()(Board* board) const { ::munmap(board, sizeof(Board)); }
};

std::unique_ptr<Board, Unmap> make_board() {
  void* memory = ::mmap(nullptr, sizeof(Board), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    std::perror("no memory to share");
    std::exit(1);
  }
  return std::unique_ptr<Board, Unmap>(new (memory) Board);
}

/// A child that ends with this process.
template <class Work>
pid_t start(const PairOptions& options, const Work& work) {
  std::fflush(nullptr);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child != 0) return child;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) std::_Exit(1);
  if (options.cpu) pin_to(*options.cpu);
  const bool done = work();
  std::fflush(nullptr);
  std::_Exit(done ? 0 : 1);
}

enum class Ending { Success, Failure, TooLate };

/// How the child ended; where that is not in time, it is killed.
Ending end_of(pid_t child, Duration limit) {
  const auto deadline = segue::RealClock::instance().now() + limit;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (segue::RealClock::instance().now() > deadline) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      return Ending::TooLate;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? Ending::Success : Ending::Failure;
}

std::string reason_of(Ending ending, const Board& board, Duration limit) {
  if (ending == Ending::TooLate) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(limit).count();
    return "not done after " + std::to_string(seconds) + " s; sample " +
           std::to_string(board.arrived.load()) + " was the last to arrive";
  }
  const std::string reason = board.failure.data();
  return reason.empty() ? "the writing process ended before it was done" : reason;
}

}  // namespace

void Board::arrive(const Stamp& sample) {
  if (sample.number == 0) {
    greeted.fetch_add(1, std::memory_order_release);
    return;
  }
  if (sample.number == kLast) return;
  const std::uint64_t before = arrived.load(std::memory_order_relaxed);
  latency_ns[sample.number % kMost].store(clock_ns() - sample.sent_ns, std::memory_order_relaxed);
  if (sample.number > before + 1) lost.fetch_add(sample.number - before - 1, std::memory_order_relaxed);
  arrived.store(sample.number, std::memory_order_release);
}

void Board::add_result(Duration duration) {
  const std::uint32_t place = results.load(std::memory_order_relaxed);
  if (place >= kMost) return;
  result_ns[place].store(duration.count(), std::memory_order_relaxed);
  results.store(place + 1, std::memory_order_release);
}

bool Board::give_up(std::string_view reason) {
  failure = {};
  std::ranges::copy(reason.substr(0, failure.size() - 1), failure.begin());
  return false;
}

Summary Board::summary() const {
  std::vector<Duration> durations;
  for (std::uint32_t i = 0; i < results.load(std::memory_order_acquire); ++i)
    durations.emplace_back(result_ns[i].load(std::memory_order_relaxed));
  return summarise(std::move(durations));
}

std::optional<Summary> run_pair(const PairOptions& options, const std::function<bool(End)>& writer,
                                const std::function<void(End)>& reader) {
  const auto board = make_board();
  int sockets[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM, 0, sockets) != 0) return std::nullopt;
  const pid_t reading = start(options, [&] {
    ::close(sockets[0]);
    reader({*board, sockets[1], options.bytes});
    return true;
  });
  const pid_t writing = start(options, [&] {
    ::close(sockets[1]);
    return writer({*board, sockets[0], options.bytes});
  });
  ::close(sockets[0]);
  ::close(sockets[1]);
  const Ending ending = writing > 0 ? end_of(writing, options.limit) : Ending::Failure;
  const bool done = ending == Ending::Success;
  if (reading > 0) end_of(reading, done ? Duration(std::chrono::seconds(2)) : Duration{0});
  if (done) return board->summary();
  if (options.failure != nullptr) *options.failure = reason_of(ending, *board, options.limit);
  return std::nullopt;
}

std::int64_t clock_ns() {
  return segue::RealClock::instance().now().time_since_epoch().count();
}

}  // namespace bench
