// SPDX-License-Identifier: Apache-2.0
#include <segue/base/time_slice.hpp>
#include <segue/concurrent/thread.hpp>

#include <pthread.h>

#include <csignal>
#include <utility>

namespace segue::concurrent {

void block_signals() {
  sigset_t all;
  sigfillset(&all);
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    sigdelset(&all, fault);
  }
  ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

namespace {

/// Sets up the calling thread, which begins.
void set_up(const char* name) {
  block_signals();
  ::pthread_setname_np(::pthread_self(), name);
  ask_for_short_time_slices();
}

}  // namespace

std::thread start_thread(const char* name, std::function<void()> work) {
  return std::thread([name, work = std::move(work)] {
    set_up(name);
    work();
  });
}

std::jthread start_stoppable_thread(const char* name, std::function<void(const std::stop_token& stop)> work) {
  return std::jthread([name, work = std::move(work)](const std::stop_token& stop) {
    set_up(name);
    work(stop);
  });
}

}  // namespace segue::concurrent
