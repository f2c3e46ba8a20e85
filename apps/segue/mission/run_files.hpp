// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/draw/gantt.hpp>

#include <filesystem>
#include <string>

#include "../command.hpp"

/// Output of the runs of missions and task networks.
namespace segue::cli {

/// Files for charts and traces of a run; "": none; "-": standard output.
struct RunFiles {
  std::string svg;
  std::string html;
  std::string trace;
  [[nodiscard]] bool any() const { return !svg.empty() || !html.empty() || !trace.empty(); }
  [[nodiscard]] bool use_output() const { return svg == "-" || html == "-" || trace == "-"; }
};

/// --svg, --html, --trace
void add_run_files(Verb& verb, RunFiles& files);
/// --html, --trace
void add_page_and_trace(Verb& verb, RunFiles& files);

/// Whether the file can be written as far as that can be known. NotFound, PermissionDenied, InvalidArgument
/// where it is not a file.
Result<void> check_writable(const std::string& file);
/// Whether all files of a run can be written; to be called before it. NotFound, PermissionDenied,
/// InvalidArgument where one is not a file or two are the same.
Result<void> check(const RunFiles& files);
/// Writes all files of a run; to be called after it. Blocks.
Result<void> write(const RunFiles& files, const draw::Gantt& gantt);

}  // namespace segue::cli
