// SPDX-License-Identifier: Apache-2.0
#include <segue/base/folders.hpp>
#include <segue/base/text.hpp>
#include <segue/model/files.hpp>
#include <segue/process_server/launch.hpp>

#include <algorithm>
#include <tuple>

namespace segue::process_server {

using type::Value;
using type::ValueMap;

namespace {

constexpr std::string_view kWhat = "a launch";

Value texts(const std::vector<std::string>& items) {
  return Value(Value::List(items.begin(), items.end()));
}

/// Reads entries of the map of a launch. A missing entry leaves its target as it is; error() is about the
/// first entry that is wrong.
class Reader {
 public:
  explicit Reader(const Value& value) : value_(value) {
    if (!value.is_map()) refuse("", "a map", value);
  }

  void read(std::string_view key, std::string& target) {
    if (const Value* found = find(key, "text", &Value::is_string)) target = found->as_string();
  }
  void read(std::string_view key, bool& target) {
    if (const Value* found = find(key, "true or false", &Value::is_bool)) target = found->as_bool();
  }
  void read(std::string_view key, std::vector<std::string>& target) {
    const Value* found = find(key, "a list of texts", &Value::is_list);
    if (found == nullptr) return;
    target.clear();
    for (const Value& item : found->as_list()) {
      if (!item.is_string()) return refuse(key, "a list of texts", item);
      target.push_back(item.as_string());
    }
  }
  void read(std::string_view key, std::size_t& target) {
    const Value* found = find(key, "a whole number", &Value::is_integer);
    if (found == nullptr) return;
    if (found->kind() == Value::Kind::Int && found->as_int() < 0) {
      return refuse(key, "a non-negative integer", *found);
    }
    target = found->as_uint();
  }
  void read(std::string_view key, model::Deployment& target) {
    const Value* found = find(key, "a map", &Value::is_map);
    if (found == nullptr) return;
    Diagnostics diagnostics;
    auto deployment = model::read_deployment(*found, {}, diagnostics);
    if (deployment) {
      target = std::move(*deployment);
    } else if (!error_) {
      error_ = diagnostics.to_error(ErrorCode::InvalidArgument);
    }
  }
  void read(std::string_view key, SharedMemoryOptions& target) {
    const Value* found = find(key, "a map", &Value::is_map);
    if (found == nullptr) return;
    Reader inner(*found);
    inner.read("prefault", target.prefault);
    inner.read("payload", target.payload);
    inner.read("control", target.control);
    if (!error_) error_ = inner.error_;
  }

  void refuse(std::string_view key, std::string_view wanted, const Value& found) {
    if (error_) return;
    const std::string entry = key.empty() ? "" : ": " + quote(key);
    error_ = fail(ErrorCode::InvalidArgument, std::string(kWhat) + entry + " must be " + std::string(wanted) +
                                                  ", got " + type::describe(found));
  }

  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  const Value* find(std::string_view key, std::string_view wanted, bool (Value::*is)() const) {
    const Value* found = value_.find(key);
    if (found == nullptr || (found->*is)()) return found;
    refuse(key, wanted, *found);
    return nullptr;
  }

  const Value& value_;
  std::optional<Error> error_;
};

Result<void> check(const Launch& launch) {
  const auto wrong = [](const std::string& message) {
    return fail(ErrorCode::InvalidArgument, std::string(kWhat) + message);
  };
  if (!is_identifier(launch.robot)) return wrong(": " + quote(launch.robot) + " cannot be a robot's name");
  if (!is_identifier(launch.deployment.process.str())) return wrong(" must name its process");
  for (const std::string& library : launch.libraries) {
    if (!is_identifier(library)) return wrong(": " + quote(library) + " cannot be a library's name");
  }
  for (const std::string& model : launch.models) {
    if (!std::filesystem::path(model).is_absolute() || model.find('\0') != std::string::npos) {
      return wrong(": " + quote(model) + " is not an absolute path");
    }
  }
  for (const std::string& peer : launch.peers) {
    if (peer.empty() || peer.find(',') != std::string::npos || peer.find('\0') != std::string::npos) {
      return wrong(": " + quote(peer) + " cannot be the address of a host");
    }
  }
  return {};
}

/// "drivers", or "drivers@onboard" where the host is not called localhost. Identifiers never contain '@', so
/// two keys never share a file.
std::string file_stem(const model::DeploymentKey& key) {
  if (key.host == model::kLocalHost || key.host.empty()) return key.process.str();
  return key.process.str() + '@' + key.host.str();
}

}  // namespace

bool operator==(const Launch& a, const Launch& b) {
  const auto attributes = [](const Launch& launch) {
    return std::tie(launch.robot, launch.deployment, launch.libraries, launch.models, launch.stand_in,
                    launch.only_stand_ins, launch.stand_ins, launch.log_level, launch.peers,
                    launch.memory.prefault, launch.memory.payload, launch.memory.control);
  };
  return attributes(a) == attributes(b);
}

Value to_value(const Launch& launch) {
  const auto size = [](std::size_t number) { return static_cast<std::uint64_t>(number); };
  return Value::map({{"robot", launch.robot},
                     {"deployment", model::to_value(launch.deployment)},
                     {"libraries", texts(launch.libraries)},
                     {"models", texts(launch.models)},
                     {"stand_in", launch.stand_in},
                     {"only_stand_ins", launch.only_stand_ins},
                     {"stand_ins", launch.stand_ins},
                     {"log_level", launch.log_level},
                     {"peers", texts(launch.peers)},
                     {"memory", Value::map({{"prefault", size(launch.memory.prefault)},
                                            {"payload", size(launch.memory.payload)},
                                            {"control", size(launch.memory.control)}})}});
}

Result<Launch> launch_from(const Value& value) {
  Launch launch;
  Reader reader(value);
  reader.read("robot", launch.robot);
  reader.read("deployment", launch.deployment);
  reader.read("libraries", launch.libraries);
  reader.read("models", launch.models);
  reader.read("stand_in", launch.stand_in);
  reader.read("only_stand_ins", launch.only_stand_ins);
  reader.read("stand_ins", launch.stand_ins);
  reader.read("log_level", launch.log_level);
  reader.read("peers", launch.peers);
  reader.read("memory", launch.memory);
  if (reader.error()) return *reader.error();
  if (auto checked = check(launch); !checked) return std::move(checked.error());
  return launch;
}

Result<std::filesystem::path> process_folder(const std::string& robot) {
  if (!is_identifier(robot)) {
    return fail(ErrorCode::InvalidArgument, quote(robot) +
                                                " cannot be a robot's name: a letter first, then letters, "
                                                "digits, '_', '-', '.'");
  }
  auto folder = runtime_folder();
  if (!folder) return folder;
  *folder /= robot;
  if (auto made = make_private_folder(*folder); !made) return std::move(made.error());
  return folder;
}

Result<std::filesystem::path> process_socket(const std::string& robot, const model::DeploymentKey& key) {
  const bool good = is_identifier(key.process.str()) && (key.host.empty() || is_identifier(key.host.str()));
  if (!good) {
    return fail(ErrorCode::InvalidArgument, quote(to_string(key)) + " cannot be the name of a process");
  }
  auto folder = process_folder(robot);
  if (!folder) return folder;
  return *folder / (file_stem(key) + ".sock");
}

std::optional<model::DeploymentKey> key_of_socket(const std::filesystem::path& socket) {
  if (socket.extension() != ".sock") return std::nullopt;
  const std::string stem = socket.stem().string();
  const auto at = stem.find('@');
  model::DeploymentKey key{model::kLocalHost, model::ProcessName(stem.substr(0, at))};
  if (at != std::string::npos) key.host = model::HostName(stem.substr(at + 1));
  if (!is_identifier(key.process.str()) || !is_identifier(key.host.str())) return std::nullopt;
  return key;
}

std::filesystem::path process_log(const std::filesystem::path& socket) {
  return std::filesystem::path(socket).replace_extension(".log");
}

}  // namespace segue::process_server
