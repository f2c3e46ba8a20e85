// SPDX-License-Identifier: Apache-2.0
#include <segue/process_server/process_service.hpp>

#include <cstring>

namespace segue::process_server {

namespace {

std::string signal_name(int signal) {
  const char* name = ::sigabbrev_np(signal);
  return name == nullptr ? "signal " + std::to_string(signal) : "SIG" + std::string(name);
}

}  // namespace

std::string to_string(const ExitReason& reason) {
  if (reason.killed) {
    return "did not end in time and was killed";
  }
  if (!reason.known) {
    return reason.requested ? "ended" : "is gone; only the process that started it knows why";
  }
  if (reason.signal != 0) {
    return "was ended by " + signal_name(reason.signal) + (reason.core_dumped ? " (core dumped)" : "");
  }
  return "ended with status " + std::to_string(reason.status);
}

}  // namespace segue::process_server
