// SPDX-License-Identifier: Apache-2.0
#include "ros2_look.hpp"

#include <segue/base/child_process.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/pipe.hpp>
#include <segue/base/text.hpp>
#include <segue/type/json.hpp>

#include <sys/types.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string_view>
#include <utility>

namespace segue::cli {

namespace {

using type::Value;

constexpr const char* kProgram = "segue-ros2";
/// Until it is killed: of a program that has written all that it has to say, and of one whose result is not
/// wanted any more.
constexpr Duration kPatienceForEnd = std::chrono::seconds(10);
constexpr Duration kPatienceForStop = std::chrono::seconds(2);

Result<std::filesystem::path> find_look_program() {
  for (const auto& prefix : install_prefixes()) {
    const auto program = prefix / "lib" / "segue" / kProgram;
    if (::access(program.c_str(), X_OK) == 0) return program;
  }
  return fail(ErrorCode::Unavailable,
              "the program segue-ros2 is not installed: install the package segue-ros2");
}

/// The failure as whoever asked for the look is told of it.
Error in_words(Error failure, std::size_t most) {
  if (failure.code == ErrorCode::DeadlineExceeded)
    failure.message = "the look at ROS 2 has not ended in time, and was stopped";
  if (failure.code == ErrorCode::ResourceExhausted)
    failure.message =
        "the nodes of ROS 2 tell more than the " + std::to_string(most >> 20) + " MiB that are taken";
  return failure;
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
Result<std::string> output_of(const std::filesystem::path& program, const std::string& argument,
                              std::size_t most, const Wait& wait) {
  auto input = make_pipe();
  if (!input) return std::move(input.error());
  auto output = make_pipe();
  if (!output) return std::move(output.error());
  const auto pid = start(program, argument, *input, *output);
  if (!pid) return pid.error();
  output->write = Descriptor();
  auto text = read_to_end(output->read, wait, most);
  output->read = Descriptor();
  input->write = Descriptor();
  wait_for_end(*pid, text ? kPatienceForEnd : kPatienceForStop);
  return text ? std::move(text) : in_words(std::move(text.error()), most);
}

/// The code of that name; Internal where it is not known.
ErrorCode code_named(std::string_view name) {
  for (int code = 0; code <= static_cast<int>(ErrorCode::Internal); ++code) {
    if (to_string(static_cast<ErrorCode>(code)) == name) return static_cast<ErrorCode>(code);
  }
  return ErrorCode::Internal;
}

}  // namespace

bool can_look_at_ros2() {
  return find_look_program().has_value();
}

Result<Value> look_at_ros2(const Ros2SystemOptions& options, Value request, const Wait& wait) {
  const auto program = options.program.empty() ? find_look_program() : options.program;
  if (!program) return program.error();
  type::ValueMap& map = request.as_map();
  map.set("domain", options.domain.value_or(-1));
  map.set("discovery", options.discovery);
  map.set("wait", format_duration(options.wait));
  map.set("patience", format_duration(options.patience));
  const auto text = output_of(*program, type::to_json(request, 0), options.most_output, wait);
  if (!text) return text.error();
  if (text->empty()) return fail(ErrorCode::Internal, "the program segue-ros2 has ended without a result");
  auto result = type::parse_json(*text, kProgram);
  if (!result) return result.error();
  const Value* error = result->find("error");
  if (error == nullptr) return result;
  return fail(code_named(error->find("code")->as_string()), error->find("message")->as_string());
}

}  // namespace segue::cli
