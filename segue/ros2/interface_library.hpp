// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/ros2/interface_definition.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace segue::ros2 {

/// Interfaces by name. Those of the packages that nearly every robot uses are built in (see
/// standard_packages()); others come from folders, which go before them. Files are read when they are first
/// asked for. Not thread safe.
class InterfaceLibrary {
 public:
  /// `folders`: each has interface packages, as PACKAGE/msg/NAME.msg or share/PACKAGE/msg/NAME.msg (so the
  /// prefix of an installation, such as /opt/ros/jazzy, will do); the first that has a file wins.
  explicit InterfaceLibrary(std::vector<std::filesystem::path> folders = {});

  /// Takes this text in place of the file or the built-in text of an interface, from when on it has not been
  /// asked for. ParseError.
  Result<void> add(const InterfaceName& name, std::string_view text);
  /// The message of that name, such as "sensor_msgs/msg/LaserScan", "std_srvs/srv/SetBool_Request", or the
  /// structure of a whole service or action. NotFound names similar ones, ParseError carries what was found
  /// in its file. The result is valid as long as the library.
  Result<const MessageDefinition*> find(std::string_view name);
  /// The message and all that it refers to, directly and through others; it comes first, the others are
  /// sorted by name. Fails where one is missing or a message contains itself.
  Result<std::vector<const MessageDefinition*>> with_parts(std::string_view name);
  /// All messages, services and actions that there are, sorted: "sensor_msgs/msg/LaserScan".
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  struct Parts {
    std::vector<std::string> around;  ///< the messages whose parts are being collected, from the outside
    std::map<std::string, const MessageDefinition*> found;
  };

  Result<void> add_parts(const MessageDefinition& message, Parts& parts);
  /// Reads the file of that interface, or its built-in text.
  Result<void> load(const InterfaceName& name);
  Result<void> read(const InterfaceName& name, std::string_view text, const std::string& file);
  [[nodiscard]] Error no_such(std::string_view name) const;

  std::vector<std::filesystem::path> folders_;
  std::map<std::string, MessageDefinition, std::less<>> messages_;
};

/// The packages that are built in: "geometry_msgs", "std_msgs" ...
std::vector<std::string> standard_packages();

}  // namespace segue::ros2
