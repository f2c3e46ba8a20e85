// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/model/network.hpp>

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace segue::runtime {

struct TemporaryHost {
  std::string name;
  std::vector<std::string> launcher{};  ///< a command that runs the words after it: {"nice", "-n", "5"}
  std::vector<std::string> options{};   ///< further ones of `segue host`: {"--listen", "127.0.0.1:0"}
};

/// Several hosts on this computer, for examples and measurements: daemons (`segue host`) with folders of
/// their own. They and all they run end with this object, and also if this process is killed. Not thread
/// safe.
class TemporaryHosts {
 public:
  TemporaryHosts() = default;
  ~TemporaryHosts();
  TemporaryHosts(const TemporaryHosts&) = delete;
  TemporaryHosts& operator=(const TemporaryHosts&) = delete;

  /// Starts daemons and blocks until they serve, half a minute at most. `program` is `segue`; empty: that
  /// beside this program. Sets $ROS_DOMAIN_ID unless it is set, so that others who do this at the same time
  /// do not look for each other's hosts; call it before there are other threads. To be called once.
  Result<void> start(const std::vector<TemporaryHost>& hosts, const std::filesystem::path& program = {});

  /// For further files; removed by the destructor.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// As robot files name it: "unix:...".
  [[nodiscard]] std::string address(const std::string& host) const;

 private:
  struct Daemon {
    std::string name;
    pid_t pid = -1;
    Descriptor input;   ///< it ends when nobody can write to it any more
    Descriptor output;  ///< its first line says that it serves
  };
  Result<void> start_daemon(const TemporaryHost& host, const std::filesystem::path& program);

  std::filesystem::path folder_;
  std::vector<Daemon> daemons_;
};

/// Places each process of a network on one of the hosts, which depends on the name of the process only.
void deal_out(model::Network& network, const std::vector<std::string>& hosts);

/// By the names of hosts, what a robot file says of them: "tcp://10.0.0.2:7447".
using HostEntries = std::map<std::string, std::string>;

/// Copies the controllers of a robot into `folder` and deals them out to hosts. Returns the robot file there,
/// which names no component libraries: all components are stand-ins.
Result<std::filesystem::path> deal_out(const std::filesystem::path& robot_file, const HostEntries& hosts,
                                       const std::filesystem::path& folder);

}  // namespace segue::runtime
