// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <filesystem>
#include <string>
#include <vector>

#include "bench_experiment.hpp"

/// How measured experiments are shown: as a table, JSON, CSV and SVG.
namespace segue::cli {

struct BenchResults {
  const BenchExperiment* experiment = nullptr;
  std::vector<BenchRow> rows;
  std::vector<std::string> failures;  ///< what could not be measured, and why
};

/// The list of all experiments.
std::string bench_list_text();
type::Value bench_list_value();

/// Title, table and footnotes.
std::string bench_text(const BenchResults& results);
type::Value bench_value(const BenchResults& results);

/// NAME.csv with every measurement, and NAME.svg where the rows differ in a number. Blocks on files.
Result<void> write_bench_files(const std::filesystem::path& folder, const BenchResults& results);

}  // namespace segue::cli
