// SPDX-License-Identifier: Apache-2.0
#include "floor.hpp"

#include <linux/futex.h>
#include <pthread.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <climits>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace bench {
namespace {

/// A word to sleep on.
struct alignas(64) Station {
  std::atomic<std::uint32_t> word{0};

  void wait(std::uint32_t old) {
    while (word.load(std::memory_order_acquire) == old) {
      ::syscall(SYS_futex, &word, FUTEX_WAIT_PRIVATE, old, nullptr, nullptr, 0);
    }
  }
  void hand_over(std::uint32_t value) {
    word.store(value, std::memory_order_release);
    ::syscall(SYS_futex, &word, FUTEX_WAKE_PRIVATE, INT_MAX, nullptr, nullptr, 0);
  }
};

}  // namespace

bool pin_to(int cpu) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(cpu), &set);
  return ::pthread_setaffinity_np(::pthread_self(), sizeof set, &set) == 0;
}

Summary futex_chain(std::size_t hops, std::size_t repeats, std::optional<int> cpu) {
  auto stations = std::make_unique<Station[]>(hops);
  std::vector<Duration> durations(repeats);
  std::atomic<std::size_t> arrived{0};
  segue::TimePoint begin;
  auto relay = [&](std::size_t station) {
    if (cpu) pin_to(*cpu);
    for (std::size_t round = 0; round < repeats; ++round) {
      stations[station].wait(static_cast<std::uint32_t>(round));
      if (station + 1 < hops) {
        stations[station + 1].hand_over(static_cast<std::uint32_t>(round + 1));
      } else {
        durations[round] = segue::RealClock::instance().now() - begin;
        arrived.store(round + 1, std::memory_order_release);
      }
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < hops; ++i)
    threads.emplace_back(relay, i);
  if (cpu) pin_to(*cpu);
  for (std::size_t round = 0; round < repeats; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // until all threads sleep
    begin = segue::RealClock::instance().now();
    stations[0].hand_over(static_cast<std::uint32_t>(round + 1));
    wait_for([&] { return arrived.load(std::memory_order_acquire) > round; });
  }
  for (std::thread& thread : threads)
    thread.join();
  return summarise(std::move(durations));
}

Summary idle_socket_chain(std::size_t relays, std::size_t repeats, std::optional<int> cpu) {
  const unsigned processors = std::max(1U, std::thread::hardware_concurrency());
  const auto place = [&](std::size_t station) {
    pin_to(cpu.value_or(static_cast<int>(station % processors)));
  };
  std::vector<std::array<int, 2>> links(relays + 1);  // link i leads to station i + 1, the last one back to 0
  for (auto& link : links)
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, link.data()) != 0) return {};
  const auto relay = [&](std::size_t station) {
    place(station);
    char byte = 0;
    while (::read(links[station - 1][1], &byte, 1) == 1 && ::write(links[station][0], &byte, 1) == 1) {
    }
    ::shutdown(links[station][0], SHUT_WR);
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i <= relays; ++i)
    threads.emplace_back(relay, i);
  std::vector<Duration> durations;
  threads.emplace_back([&] {
    place(0);
    for (std::size_t round = 0; round < repeats; ++round) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20 + round * 7 % 23));
      const segue::TimePoint begin = segue::RealClock::instance().now();
      char byte = 1;
      if (::write(links.front()[0], &byte, 1) != 1 || ::read(links.back()[1], &byte, 1) != 1) break;
      durations.push_back(segue::RealClock::instance().now() - begin);
    }
    ::shutdown(links.front()[0], SHUT_WR);
  });
  for (std::thread& thread : threads)
    thread.join();
  for (const auto& link : links)
    for (const int end : link)
      ::close(end);
  return summarise(std::move(durations));
}

Summary bare_thread(std::size_t repeats) {
  return measure(repeats, [] { std::thread([] {}).join(); });
}

}  // namespace bench
