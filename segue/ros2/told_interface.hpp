// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/ros2/interface_definition.hpp>
#include <segue/type/value.hpp>

#include <map>
#include <string>
#include <string_view>
#include <vector>

/// Interfaces that a running node tells (type_description_interfaces/srv/GetTypeDescription).
namespace segue::ros2 {

/// The file of an interface.
struct InterfaceFile {
  std::string path;  ///< within a folder of interface packages: "my_msgs/msg/Label.msg"
  std::string text;
};

/// The hashes of an interface and of its parts, by their names ("my_msgs/srv/Ask",
/// "my_msgs/srv/Ask_Request").
using TypeHashes = std::map<std::string, std::string, std::less<>>;

/// The types that a node has told, which are untrusted.
class ToldInterfaces {
 public:
  /// Notes the types that a response describes. InvalidArgument: the node refuses to tell the type of that
  /// name, or its description is malformed.
  Result<void> add(const type::Value& response, std::string_view name);

  /// The files of a message, a service or an action, and of the messages that it refers to, but for those
  /// that are built in with the same fields. The node's own text is taken where it has the fields that the
  /// node describes, since descriptions have neither constants nor defaults. InvalidArgument: there is no
  /// hash, a part of it was not told, or what the files say is of another hash.
  [[nodiscard]] Result<std::vector<InterfaceFile>> files(const std::string& interface,
                                                         const TypeHashes& hashes) const;

 private:
  /// The messages that the file of an interface has, in the order of its sections. NotFound.
  [[nodiscard]] Result<std::vector<const MessageDefinition*>> sections_of(const InterfaceName& name) const;
  [[nodiscard]] bool is_as_told(const std::vector<MessageDefinition>& messages) const;
  [[nodiscard]] std::string text_of(const InterfaceName& name,
                                    const std::vector<const MessageDefinition*>& sections) const;
  /// With those that it refers to, but for those that are built in.
  [[nodiscard]] Result<std::map<std::string, std::string>> texts_of(const std::string& interface) const;

  std::map<std::string, MessageDefinition, std::less<>> messages_;
  std::map<std::string, std::string, std::less<>> sources_;  ///< texts of files, by interface
};

/// The text of a .msg file.
std::string message_text(const MessageDefinition& message);

}  // namespace segue::ros2
