// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iceoryx_hoofs/log/logmanager.hpp>
#include <iceoryx_posh/popo/untyped_publisher.hpp>
#include <iceoryx_posh/popo/untyped_subscriber.hpp>
#include <iceoryx_posh/popo/wait_set.hpp>
#include <iceoryx_posh/runtime/posh_runtime.hpp>

#include <string>

#include <unistd.h>

namespace bench {

/// Names must be unique: RouDi notices the end of a process of that name with a delay.
inline void join_iceoryx(const std::string& name) {
  iox::log::LogManager::GetLogManager().SetDefaultLogLevel(iox::log::LogLevel::kOff,
                                                           iox::log::LogLevelOutput::kHideLogLevel);
  const std::string unique = name + "-" + std::to_string(::getpid());
  iox::runtime::PoshRuntime::initRuntime(iox::RuntimeName_t(iox::cxx::TruncateToCapacity, unique));
}

inline iox::capro::ServiceDescription iceoryx_topic(const std::string& name) {
  return {"segue", "bench", iox::capro::IdString_t(iox::cxx::TruncateToCapacity, name)};
}

inline iox::popo::SubscriberOptions iceoryx_queue(std::uint64_t capacity) {
  iox::popo::SubscriberOptions options;
  options.queueCapacity = capacity;
  return options;
}

}  // namespace bench
