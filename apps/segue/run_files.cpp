// SPDX-License-Identifier: Apache-2.0
#include "run_files.hpp"

#include <segue/base/file.hpp>
#include <segue/base/text.hpp>

#include <fmt/format.h>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "output.hpp"
#include "run_times.hpp"

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
  verb.option("--svg FILE", files.svg, "also write a drawing of the run");
  add_page_and_trace(verb, files);
}

void add_page_and_trace(Verb& verb, RunFiles& files) {
  verb.option("--html FILE", files.html, "also write a page with the run to look around in");
  verb.option("--trace FILE", files.trace, "also write a trace for Perfetto");
}

Result<void> check(const RunFiles& files) {
  std::vector<std::string> seen;
  for (const std::string* file : {&files.svg, &files.html, &files.trace}) {
    if (file->empty()) continue;
    if (auto fits = *file == "-" ? Result<void>{} : check_writable(*file); !fits) return fits;
    if (std::ranges::find(seen, *file) != seen.end())
      return fail(ErrorCode::InvalidArgument, quote(*file) + " cannot hold two things");
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
      print(form(gantt));
    } else if (auto written = write_file(file, form(gantt)); !written) {
      return written;
    }
  }
  return {};
}

namespace {

std::vector<std::string> row(const cdtn::TaskNetwork& network, const cdtn::RunResult& result,
                             const cdtn::WaitFinder& finder, cdtn::NodeId node) {
  const cdtn::NodeResult& own = result.nodes[cdtn::index(node)];
  std::string last;
  if (const auto waits = finder.of(node); !waits.empty()) {
    const cdtn::NodeId other = waits.back().node;
    last = to_string(waits.back(), cdtn::index(other) == cdtn::kNone ? "" : network.label(other));
  }
  const auto time = [&](TimePoint point) {
    return own.attempts == 0 ? std::string("-") : fmt::format("{:.2f}", seconds(point.time_since_epoch()));
  };
  const bool in_vain = own.status == cdtn::NodeStatus::Skipped;
  return {printable(network.label(node)), time(own.started), time(own.ended),
          in_vain ? "thrown away" : std::string(to_string(own.status)), printable(last)};
}

}  // namespace

void show_run(const cdtn::TaskNetwork& network, const cdtn::Order& order, const cdtn::RunResult& result,
              const cdtn::RunSummary& summary, const Context& context) {
  if (context.json()) return print_json(cdtn::to_value(network, order, result, summary));
  const cdtn::WaitFinder finder(network, order, result);
  Table table({{"node"},
               {"start", Table::Align::Right},
               {"end", Table::Align::Right},
               {"status"},
               {"waited last for"}});
  std::size_t unwanted = 0;
  for (std::uint32_t i = 0; i < result.nodes.size(); ++i) {
    const cdtn::NodeResult& node = result.nodes[i];
    if (node.status == cdtn::NodeStatus::Skipped && node.attempts == 0)
      ++unwanted;
    else
      table.add(row(network, result, finder, cdtn::NodeId{i}));
  }
  print(table.text());
  if (unwanted > 0) print_line(fmt::format("and {} not on the path taken", unwanted));
  print_line(fmt::format("{} in {:.2f} s; one after the other {:.2f} s, critical path {:.2f} s",
                         result.done() ? "done" : "ended", seconds(result.makespan),
                         seconds(summary.sequential), seconds(summary.critical_path)));
}

}  // namespace segue::cli
