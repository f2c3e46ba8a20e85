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

std::thread start_thread(const char* name, std::function<void()> work) {
  return std::thread([name, work = std::move(work)] {
    block_signals();
    ::pthread_setname_np(::pthread_self(), name);
    ask_for_short_time_slices();
    work();
  });
}

}  // namespace segue::concurrent
