// SPDX-License-Identifier: Apache-2.0
#include <segue/base/error.hpp>
#include <segue/process_server/assignment.hpp>
#include <segue/type/json.hpp>
#include <segue/type/value_at.hpp>

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>

namespace segue::process_server {

using type::Value;

namespace {

constexpr off_t kLargest = off_t{16} << 20;
constexpr int kMostFiles = 1000;

Error wrong(const std::string& what) {
  return fail(ErrorCode::InvalidArgument,
              "segue-deployment is started by a process server, which hands it an assignment: " + what);
}

}  // namespace

Result<Descriptor> write_assignment(const Assignment& assignment) {
  const std::string text =
      type::to_json(Value::map({{"launch", to_value(assignment.launch)},
                                {"socket", assignment.socket.native()},
                                {"log", assignment.log.native()},
                                {"log_size", static_cast<std::uint64_t>(assignment.log_size)},
                                {"log_files", assignment.log_files}}),
                    -1);
  Descriptor file(::memfd_create("segue-launch", MFD_CLOEXEC));
  if (!file.valid()) return system_error("cannot make a file for a launch", errno);
  if (::pwrite(file.get(), text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) {
    return system_error("cannot write a launch", errno);
  }
  return file;
}

Result<Assignment> read_assignment(int descriptor) {
  const off_t size = ::lseek(descriptor, 0, SEEK_END);
  if (size <= 0 || size > kLargest) return wrong("there is none");
  std::string text(static_cast<std::size_t>(size), '\0');
  if (::pread(descriptor, text.data(), text.size(), 0) != size) return wrong("it cannot be read");
  const auto value = type::parse_json(text, "launch");
  if (!value) return wrong("it is not JSON").because_of(value.error());
  const Value* launch = value->find("launch");
  if (launch == nullptr) return wrong("it has no launch");
  auto read = launch_from(*launch);
  if (!read) return std::move(read.error());
  Assignment assignment{std::move(*read), text_at(*value, "socket"), text_at(*value, "log")};
  const Value* log_size = value->find("log_size");
  const Value* log_files = value->find("log_files");
  if (log_size != nullptr && log_size->kind() == Value::Kind::Int && log_size->as_int() >= 0) {
    assignment.log_size = log_size->as_uint();
  }
  if (log_files != nullptr && log_files->kind() == Value::Kind::Int && log_files->as_int() >= 0 &&
      log_files->as_int() <= kMostFiles) {
    assignment.log_files = static_cast<int>(log_files->as_int());
  }
  return assignment;
}

}  // namespace segue::process_server
