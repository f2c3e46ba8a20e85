// SPDX-License-Identifier: Apache-2.0
#include "ros2_system.hpp"

#include <segue/base/child_process.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/pipe.hpp>
#include <segue/base/text.hpp>
#include <segue/type/json.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <utility>

#include "output.hpp"

namespace segue::cli {

namespace {

using type::Value;

constexpr const char* kProgram = "segue-ros2";
constexpr int kMostDomain = 232;
constexpr auto kShortLook = std::chrono::milliseconds(500);
/// The program has written all that it has to say.
constexpr auto kPatienceForEnd = std::chrono::seconds(10);

Result<std::filesystem::path> find_look_program() {
  for (const auto& prefix : install_prefixes()) {
    const auto program = prefix / "lib" / "segue" / kProgram;
    if (::access(program.c_str(), X_OK) == 0) return program;
  }
  return fail(ErrorCode::Unavailable,
              "the program segue-ros2 is not installed: install the package segue-ros2");
}

Result<std::string> read_all(int descriptor) {
  std::string all;
  std::array<char, 65536> part{};
  for (;;) {
    const ssize_t count = ::read(descriptor, part.data(), part.size());
    if (count == 0) return all;
    if (count > 0) {
      all.append(part.data(), static_cast<std::size_t>(count));
    } else if (errno != EINTR) {
      return system_error(kProgram, errno);
    }
  }
}

/// The copies of the pipes that it makes are closed, but for those of the child.
Result<pid_t> start(const std::filesystem::path& program, const std::string& argument, const Pipe& input,
                    const Pipe& output) {
  ChildProcess child(STDERR_FILENO + 1);
  for (const auto& [source, number] : {std::pair{input.read.get(), STDIN_FILENO},
                                       {output.write.get(), STDOUT_FILENO},
                                       {STDERR_FILENO, STDERR_FILENO}}) {
    if (auto handed = child.hand_over(source, number); !handed) return std::move(handed.error());
  }
  return child.start(program.string(), {kProgram, argument}, std::string(kProgram) + ": ");
}

/// Runs the program; its standard input, which it watches, ends with this process.
Result<std::string> output_of(const std::filesystem::path& program, const std::string& argument) {
  auto input = make_pipe();
  if (!input) return std::move(input.error());
  auto output = make_pipe();
  if (!output) return std::move(output.error());
  const auto pid = start(program, argument, *input, *output);
  if (!pid) return pid.error();
  output->write = Descriptor();
  auto text = read_all(output->read.get());
  input->write = Descriptor();
  wait_for_end(*pid, kPatienceForEnd);
  return text;
}

/// Shells expand what they complete.
bool is_shell_word(std::string_view text) {
  return std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '/';
  });
}

/// The code of that name; Internal where it is not known.
ErrorCode code_named(std::string_view name) {
  for (int code = 0; code <= static_cast<int>(ErrorCode::Internal); ++code) {
    if (to_string(static_cast<ErrorCode>(code)) == name) return static_cast<ErrorCode>(code);
  }
  return ErrorCode::Internal;
}

Result<void> parse_domain(const std::string& text, std::optional<int>& domain) {
  int number = -1;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc() || end != text.data() + text.size() || number < 0 || number > kMostDomain)
    return fail(ErrorCode::InvalidArgument, text + " is not a valid domain: expected 0 to 232");
  domain = number;
  return {};
}

}  // namespace

void add_ros2_system_options(Verb& verb, Ros2SystemOptions& options, bool asks) {
  verb.option(
      "--domain N", [&options](const std::string& text) { return parse_domain(text, options.domain); },
      "domain of ROS 2, 0 to 232 (default: $ROS_DOMAIN_ID, or 0)");
  verb.option(
          "--discovery RANGE", options.discovery,
          "localhost or subnet (default: as $ROS_AUTOMATIC_DISCOVERY_RANGE or $ROS_LOCALHOST_ONLY say, else "
          "subnet)")
      .one_of({"localhost", "subnet"});
  verb.option("--wait DURATION", options.wait, "how long nodes are listened for (default: 3s)")
      .between(std::chrono::milliseconds(1), kLongestWait);
  if (!asks) return;
  verb.option("--timeout DURATION", options.patience, "how long a node has for its answers (default: 5s)")
      .between(std::chrono::milliseconds(1), kLongestWait);
}

Result<Value> look_at_ros2(const Ros2SystemOptions& options, Value request) {
  const auto program = find_look_program();
  if (!program) return program.error();
  type::ValueMap& map = request.as_map();
  map.set("domain", options.domain.value_or(-1));
  map.set("discovery", options.discovery);
  map.set("wait", format_duration(options.wait));
  map.set("patience", format_duration(options.patience));
  const auto text = output_of(*program, type::to_json(request, 0));
  if (!text) return text.error();
  if (text->empty()) return fail(ErrorCode::Internal, "the program segue-ros2 has ended without a result");
  auto result = type::parse_json(*text, kProgram);
  if (!result) return result.error();
  const Value* error = result->find("error");
  if (error == nullptr) return result;
  return fail(code_named(error->find("code")->as_string()), error->find("message")->as_string());
}

std::vector<std::string> ros2_node_names() {
  Ros2SystemOptions options;
  options.wait = kShortLook;
  const auto seen = look_at_ros2(options, Value::map({{"brief", true}}));
  std::vector<std::string> names;
  for (const Value& node : seen ? list_at(*seen, "nodes") : Value::List()) {
    const std::string& name = node.find("name")->as_string();
    if (is_shell_word(name) && name.find("/_") == std::string::npos) names.push_back(name);
  }
  return names;
}

void print_problems(const Value& seen) {
  for (const Value& problem : seen.find("problems")->as_list())
    print_note(problem.as_string());
}

std::string joined_names(const Value& list) {
  std::string text;
  for (const Value& name : list.as_list()) {
    const std::string& one = name.as_string();
    text += (text.empty() ? "" : ", ") + (one.empty() ? "(not of a node)" : one);
  }
  return text;
}

}  // namespace segue::cli
