// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "measure.hpp"

#include <optional>

/// Baselines: the time that the operating system needs for the same job without Segue.
namespace bench {

/// One thread writes a word and wakes the next with a futex, `hops` in a row, paced so that every thread
/// sleeps before its turn. The time from the first write to the last wake-up, of the whole chain. With `cpu`
/// all threads are pinned to it.
Summary futex_chain(std::size_t hops, std::size_t repeats, std::optional<int> cpu);

/// A byte goes over Unix sockets from one thread to the next and back, through `relays` threads in all, each
/// of which sleeps before. It starts after pauses of 20 to 42 ms, as the machine cools down in. With `cpu`
/// all threads are pinned to it; otherwise each runs on another processor than the one before it.
Summary idle_socket_chain(std::size_t relays, std::size_t repeats, std::optional<int> cpu);

/// Creating and joining a bare thread.
Summary bare_thread(std::size_t repeats);

/// Pins the calling thread; false if the system does not permit it.
bool pin_to(int cpu);

}  // namespace bench
