// SPDX-License-Identifier: Apache-2.0
#include "run_files.hpp"

#include <segue/base/file.hpp>
#include <segue/base/text.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "../output.hpp"

namespace segue::cli {

namespace fs = std::filesystem;

Result<void> check_writable(const std::string& file) {
  const fs::path path(file);
  struct stat entry {};
  if (::stat(path.c_str(), &entry) == 0 && !S_ISREG(entry.st_mode))
    return fail(ErrorCode::InvalidArgument, "cannot write " + quote(file) + ": it is not a file");
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  int reason = ::stat(folder.c_str(), &entry) == 0 ? 0 : errno;
  if (reason == 0 && !S_ISDIR(entry.st_mode)) reason = ENOTDIR;
  if (reason == 0 && ::access(folder.c_str(), W_OK | X_OK) != 0) reason = errno;
  if (reason == 0) return {};
  const ErrorCode code = reason == ENOENT ? ErrorCode::NotFound : ErrorCode::PermissionDenied;
  return fail(code, "cannot write " + quote(file) + ": " + std::strerror(reason));
}

void add_run_files(Verb& verb, RunFiles& files) {
  verb.option("--svg FILE", files.svg, "also write a Gantt chart of the run");
  add_page_and_trace(verb, files);
}

void add_page_and_trace(Verb& verb, RunFiles& files) {
  verb.option("--html FILE", files.html, "also write an interactive page with the run");
  verb.option("--trace FILE", files.trace, "also write a trace for Perfetto");
}

Result<void> check(const RunFiles& files) {
  std::vector<std::string> seen;
  for (const std::string* file : {&files.svg, &files.html, &files.trace}) {
    if (file->empty()) continue;
    if (auto fits = *file == "-" ? Result<void>{} : check_writable(*file); !fits) return fits;
    if (std::ranges::find(seen, *file) != seen.end())
      return fail(ErrorCode::InvalidArgument, quote(*file) + " cannot be used for two outputs");
    seen.push_back(*file);
  }
  return {};
}

Result<void> write(const RunFiles& files, const draw::Gantt& gantt) {
  using Form = std::string (*)(const draw::Gantt&);
  const std::pair<const std::string&, Form> forms[] = {
      {files.svg, draw::to_svg}, {files.html, draw::to_html}, {files.trace, draw::to_trace}};
  for (const auto& [file, form] : forms) {
    if (file.empty()) continue;
    if (file == "-") {
      print_content(form(gantt));
    } else if (auto written = write_file(file, form(gantt)); !written) {
      return written;
    }
  }
  return {};
}

}  // namespace segue::cli
