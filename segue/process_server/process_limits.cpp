// SPDX-License-Identifier: Apache-2.0
#include <segue/base/error.hpp>
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/process_server/process_limits.hpp>

#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>

namespace segue::process_server {

namespace {

using Resource = decltype(RLIMIT_DATA);

/// Sets both the soft and the hard limit, so that no component can raise it again. Fails where the system's
/// own limit is lower.
Result<void> limit(Resource resource, std::uint64_t most, const std::string& what) {
  const rlimit wanted{most, most};
  if (::setrlimit(resource, &wanted) == 0) return {};
  const int reason = errno;
  rlimit now{};
  ::getrlimit(resource, &now);
  return system_error("the system does not permit the limit " + what + " (at most " +
                          std::to_string(now.rlim_max) + "); ask for less, or raise it with ulimit",
                      reason);
}

Result<void> apply_limits(const model::ResourceLimits& limits) {
  if (limits.open_files) {
    auto done = limit(RLIMIT_NOFILE, *limits.open_files, "open_files");
    if (!done) return done;
  }
  if (limits.cpu_time) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(*limits.cpu_time).count();
    auto done = limit(RLIMIT_CPU, static_cast<std::uint64_t>(seconds), "cpu_time");
    if (!done) return done;
  }
  if (limits.core) {
    if (auto done = limit(RLIMIT_CORE, *limits.core, "core"); !done) return done;
  }
  if (limits.memory) return limit(RLIMIT_DATA, *limits.memory, "memory");
  return {};
}

Result<void> apply_processors(const std::vector<int>& processors) {
  if (processors.empty()) return {};
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int processor : processors) {
    if (processor < 0 || processor >= CPU_SETSIZE) {
      return fail(ErrorCode::InvalidArgument, "there is no processor " + std::to_string(processor));
    }
    CPU_SET(static_cast<std::size_t>(processor), &set);
  }
  if (::sched_setaffinity(0, sizeof set, &set) == 0) return {};
  if (errno == EINVAL) {
    return fail(ErrorCode::InvalidArgument, "this computer has none of the processors that 'cpu' names");
  }
  return system_error("cannot choose the processors", errno);
}

Result<void> apply_scheduler(const model::Deployment& deployment) {
  if (deployment.scheduler == Scheduler::Normal) return {};
  sched_param parameters{};
  parameters.sched_priority = deployment.priority;
  const int policy = deployment.scheduler == Scheduler::Fifo ? SCHED_FIFO : SCHED_RR;
  if (::sched_setscheduler(0, policy, &parameters) == 0) return {};
  const int reason = errno;
  const std::string what = "the system does not permit scheduler " +
                           std::string(to_string(deployment.scheduler)) + " with priority " +
                           std::to_string(deployment.priority);
  if (reason != EPERM) return system_error(what, reason);
  if (deployment.optional) {
    log(LogLevel::Warning, "segue-deployment",
        what + "; it is optional, so the process runs with the normal one");
    return {};
  }
  return fail(ErrorCode::PermissionDenied,
              what +
                  "; grant CAP_SYS_NICE or a higher rtprio limit (ulimit -r, /etc/security/limits.conf), or "
                  "say 'optional: true'");
}

void set_peers(const std::vector<std::string>& peers) {
  std::string all;
  for (const std::string& peer : peers)
    all += (all.empty() ? "" : ",") + peer;
  if (!all.empty()) ::setenv("SEGUE_PEERS", all.c_str(), 1);
}

}  // namespace

Result<void> apply_to_this_process(const Launch& launch) {
  set_peers(launch.peers);
  const model::Deployment& deployment = launch.deployment;
  for (const auto& [name, value] : deployment.environment)
    ::setenv(name.c_str(), value.c_str(), 1);
  if (auto done = apply_processors(deployment.cpus); !done) return done;
  if (auto done = apply_scheduler(deployment); !done) return done;
  return apply_limits(deployment.limits);
}

}  // namespace segue::process_server
