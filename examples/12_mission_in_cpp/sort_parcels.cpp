// SPDX-License-Identifier: Apache-2.0
// A mission whose actions are C++ functions: sort_parcels MISSION_FILE GRAMS...
#include <segue/mission_run/loaded_mission.hpp>

#include <cstdio>
#include <cstdlib>
#include <deque>
#include <string>

using namespace segue;

namespace {

/// The actions of the mission. They run on the engine's thread, one at a time, so they need no lock.
class Warehouse {
 public:
  explicit Warehouse(std::deque<double> parcels) : parcels_(std::move(parcels)) {}

  /// An action ends with one of its outcomes, after it has set its outputs.
  mission::Ending fetch(mission::ActionCall& call) {
    if (parcels_.empty()) return {*call.outcome("empty"), {}};
    call.set_output("grams", parcels_.front());
    parcels_.pop_front();
    return {*call.outcome("fetched"), {}};
  }

  /// It aborts with a reason if it cannot do what it should.
  static mission::Ending weigh(mission::ActionCall& call) {
    const double grams = call.input("grams").as_double();
    if (grams <= 0) return {mission::kAborted, "the scales show nothing"};
    return {*call.outcome(grams > 500 ? "heavy" : "light"), {}};
  }

  static mission::Ending carry(mission::ActionCall& call) {
    std::printf("%g g to the %s\n", call.input("grams").as_double(), call.input("to").as_string().c_str());
    return {*call.outcome("success"), {}};
  }

 private:
  std::deque<double> parcels_;
};

int fail_with(const std::string& message) {
  std::fprintf(stderr, "%s\n", message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return fail_with("usage: sort_parcels MISSION_FILE GRAMS...");
  const auto mission = mission_run::LoadedMission::load(argv[1]);
  if (!mission) return fail_with(to_string(diagnostics_of(mission.error())));
  std::deque<double> parcels;
  for (int i = 2; i < argc; ++i)
    parcels.push_back(std::atof(argv[i]));

  Warehouse warehouse(std::move(parcels));
  mission_run::RunRequest request;  // sequentially, unless `mode` says otherwise
  request.runners.add("fetch", [&](mission::ActionCall& call) { return warehouse.fetch(call); });
  request.runners.add("weigh", Warehouse::weigh);
  request.runners.add("carry", Warehouse::carry);
  const auto run = mission->run(request);
  if (!run) return fail_with(to_string(run.error()));  // such as a callback that nobody provides

  const mission_run::RunOverview& overview = (*run)->overview();
  std::printf("%s after %zu actions\n", overview.outcome.c_str(), overview.actions);
  if (overview.error) std::printf("%s\n", to_string(*overview.error).c_str());
  return overview.outcome == "done" ? 0 : 1;
}
