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

/// Creating and joining a bare thread.
Summary bare_thread(std::size_t repeats);

/// Pins the calling thread; false if the system does not permit it.
bool pin_to(int cpu);

}  // namespace bench
