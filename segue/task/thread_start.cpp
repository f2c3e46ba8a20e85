// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/task/thread_start.hpp>

#include <sched.h>

#include <cstring>

namespace segue::task::detail {

namespace {

/// pthread_attr_t as a value.
class Attributes {
 public:
  Attributes() { pthread_attr_init(&attributes_); }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
  ~Attributes() { pthread_attr_destroy(&attributes_); }
  pthread_attr_t* get() { return &attributes_; }

  void set_scheduler(const Activity& activity) {
    sched_param parameters{};
    parameters.sched_priority = activity.priority;
    pthread_attr_setinheritsched(get(), PTHREAD_EXPLICIT_SCHED);
    pthread_attr_setschedpolicy(get(), activity.scheduler == Scheduler::Fifo ? SCHED_FIFO : SCHED_RR);
    pthread_attr_setschedparam(get(), &parameters);
  }
  void set_processors(const std::vector<int>& processors) {
    cpu_set_t set;
    CPU_ZERO(&set);
    for (const int processor : processors)
      CPU_SET(static_cast<std::size_t>(processor), &set);
    pthread_attr_setaffinity_np(get(), sizeof set, &set);
  }

 private:
  pthread_attr_t attributes_{};
};

Result<void> check(const std::string& name, const Activity& activity) {
  const bool real_time = activity.scheduler != Scheduler::Normal;
  if (real_time && (activity.priority < 1 || activity.priority > 99)) {
    return fail(ErrorCode::InvalidArgument,
                "priority " + std::to_string(activity.priority) + " for scheduler " +
                    std::string(to_string(activity.scheduler)) + ": choose one from 1 to 99",
                name);
  }
  if (activity.spin < Duration::zero() || activity.spin > kLongestSpin) {
    return fail(ErrorCode::InvalidArgument,
                "a thread spins for at most " + format_duration(kLongestSpin) + ", not " +
                    format_duration(activity.spin),
                name);
  }
  for (const int processor : activity.cpus) {
    if (processor >= 0 && processor < CPU_SETSIZE) continue;
    return fail(ErrorCode::InvalidArgument, "there is no processor " + std::to_string(processor), name);
  }
  return {};
}

Error refused(int code, const std::string& name, const Activity& activity) {
  const std::string scheduler(to_string(activity.scheduler));
  if (code == EPERM) {
    return fail(
        ErrorCode::PermissionDenied,
        "the system does not permit scheduler " + scheduler + " with priority " +
            std::to_string(activity.priority) +
            "; grant CAP_SYS_NICE or a higher rtprio limit (ulimit -r, /etc/security/limits.conf), or "
            "make it optional",
        name);
  }
  if (code == EINVAL && !activity.cpus.empty()) {
    return fail(ErrorCode::InvalidArgument, "this computer has none of the processors asked for", name);
  }
  return fail(ErrorCode::ResourceExhausted, std::string("cannot start a thread: ") + std::strerror(code),
              name);
}

}  // namespace

Result<StartedThread> start_thread(const std::string& name, const Activity& activity, void* (*main)(void*),
                                   void* argument) {
  if (auto checked = check(name, activity); !checked) return std::move(checked.error());
  StartedThread started;
  Attributes attributes;
  if (!activity.cpus.empty()) attributes.set_processors(activity.cpus);
  int code = EPERM;
  if (activity.scheduler != Scheduler::Normal) {
    Attributes real_time;
    if (!activity.cpus.empty()) real_time.set_processors(activity.cpus);
    real_time.set_scheduler(activity);
    code = pthread_create(&started.thread, real_time.get(), main, argument);
    if (code == EPERM && activity.optional) {
      started.scheduler_granted = false;
      code = pthread_create(&started.thread, attributes.get(), main, argument);
    }
  } else {
    code = pthread_create(&started.thread, attributes.get(), main, argument);
  }
  if (code != 0) return refused(code, name, activity);
  pthread_setname_np(started.thread, name.substr(0, 15).c_str());
  return started;
}

}  // namespace segue::task::detail
