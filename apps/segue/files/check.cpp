// SPDX-License-Identifier: Apache-2.0
#include <segue/base/input_file.hpp>
#include <segue/base/text.hpp>
#include <segue/journal/journal_reader.hpp>
#include <segue/mission_plan/plan_mapping.hpp>
#include <segue/model/files.hpp>
#include <segue/model/hints.hpp>
#include <segue/model/validate.hpp>
#include <segue/pddl/pddl.hpp>
#include <segue/solve/check_transitions.hpp>
#include <segue/task_host/stand_in.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>

#include "../mission/checked_missions.hpp"
#include "../models.hpp"
#include "../output.hpp"
#include "../ros2/ros2_ports.hpp"

namespace segue::cli {

namespace {

using model::Depth;
using model::FileKind;

struct CheckOptions {
  std::vector<std::string> files;
  bool structure = false;
  bool hints = false;
  std::vector<std::string> libraries;
  ModelSources sources;
};

/// Reads files of all kinds and collects their problems.
class Checker {
 public:
  explicit Checker(const CheckOptions& options) : options_(options), missions_(options.libraries) {
    catalog_ = load_catalog(options.sources, diagnostics_);
  }

  void run() {
    for (const std::string& file : options_.files)
      read(file);
    check_pddl();
    model::resolve_inheritance(catalog_, diagnostics_);
    // Networks last: they may use the models of files named after them.
    for (const auto& parts : networks_)
      check(parts, options_.structure ? Depth::Structure : depth_for(parts.network));
    diagnostics_.sort();
  }

  [[nodiscard]] const Diagnostics& diagnostics() const { return diagnostics_; }
  [[nodiscard]] const CheckedMissions& missions() const { return missions_; }
  [[nodiscard]] std::size_t files() const { return files_; }
  /// How many hints there are that were not asked for.
  [[nodiscard]] std::size_t hidden_hints() const { return hidden_hints_; }
  [[nodiscard]] const std::vector<std::string>& shallow() const { return shallow_; }

 private:
  /// The parts of a network file that could be read.
  struct Parts {
    model::Network network;
    bool complete = false;
  };

  /// Nothing and a diagnostic where it cannot be read.
  std::optional<std::string> text_of(const std::string& file) {
    ++files_;
    auto text = read_input_file(file);
    if (text) return std::move(*text);
    diagnostics_.error("unreadable-file", text.error().message, {file, 0, 0});
    return std::nullopt;
  }

  void read(const std::string& file) {
    if (is_rafcon_machine(file)) {
      ++files_;
      return missions_.check(file, diagnostics_);
    }
    if (is_journal(file)) {
      ++files_;
      return check_journal(file);
    }
    const auto text = text_of(file);
    if (!text) return;
    switch (model::kind_of_file(file, *text)) {
      case FileKind::Network:
      case FileKind::Cnd:
        if (auto parts = read_parts(*text, file)) networks_.push_back(std::move(*parts));
        return;
      case FileKind::Transition:
        model::read_transition(*text, file, diagnostics_);
        return;
      case FileKind::Robot:
        read_robot(*text, file);
        return;
      case FileKind::Mission:
      case FileKind::TaskNetwork:
        missions_.check(file, diagnostics_);
        return;
      case FileKind::StandIns:
        (void)task_host::StandInTable::load(file, diagnostics_);
        return;
      case FileKind::PlanMapping:
        (void)mission::load_mapping(file, diagnostics_);
        return;
      case FileKind::Pddl:
        pddl_.emplace_back(file, *text);
        return;
      case FileKind::Components:
      case FileKind::Typelib:
        model::read_components(*text, file, catalog_, diagnostics_);
        return;
      case FileKind::Unknown:
        explain_unknown(file, *text);
    }
  }

  void explain_unknown(const std::string& file, const std::string& text) {
    // The kind of a YAML file that cannot be parsed is unknown; the error of the parser is more helpful.
    Diagnostics parsing;
    model::read_network(text, file, parsing);
    const auto& found = parsing.items();
    const bool broken = std::any_of(found.begin(), found.end(), [](const Diagnostic& item) {
      return item.code.find("parse") != std::string::npos;
    });
    if (broken) return diagnostics_.append(parsing);
    diagnostics_.error(
        "unknown-kind",
        "this is not a network, robot, mission, task network, transition, component model, stand-in, PDDL, "
        "mapping or .tlb file; a network has `tasks:`, a robot file `robot:`, a mission `mission:` at its "
        "top",
        {file, 0, 0});
  }

  std::optional<Parts> read_parts(const std::string& text, const std::string& file) {
    const std::size_t errors_before = diagnostics_.error_count();
    auto network = model::read_network_parts(text, file, diagnostics_, read_input_file);
    if (!network) return std::nullopt;
    return Parts{std::move(*network), diagnostics_.error_count() == errors_before};
  }

  /// All that could be read of the robot file and of the files that it names is checked, whatever errors the
  /// rest has.
  void read_robot(const std::string& text, const std::string& file) {
    const std::size_t errors_before = diagnostics_.error_count();
    const auto robot = model::read_robot_parts(text, file, diagnostics_);
    if (!robot) return;
    bool complete = diagnostics_.error_count() == errors_before;
    add_robot_models(*robot, catalog_, diagnostics_);
    model::resolve_inheritance(catalog_, diagnostics_);
    std::vector<Parts> controllers;
    for (const std::string& pattern : robot->controllers) {
      for (const auto& path : files_of(*robot, pattern, diagnostics_)) {
        const auto content = text_of(path.string());
        auto parts = content ? read_parts(*content, path.string()) : std::nullopt;
        complete = complete && parts;
        if (parts) controllers.push_back(std::move(*parts));
      }
    }
    std::vector<model::Network> networks;
    for (const Parts& parts : controllers)
      networks.push_back(parts.network);
    check_missions(*robot, complete ? &networks : nullptr);
    check_robot(*robot, networks, complete);
    const auto depth = options_.structure ? Depth::Structure : Depth::Full;
    for (const auto& parts : controllers)
      check(parts, depth);
    const auto transitions = read_transitions(*robot);
    // Where anything else has errors, these may follow from it.
    if (diagnostics_.error_count() == errors_before)
      diagnostics_.append(solve::check_transitions(transitions, networks, catalog_, depth));
  }

  std::vector<model::Transition> read_transitions(const model::Robot& robot) {
    std::vector<model::Transition> transitions;
    for (const std::string& pattern : robot.transitions) {
      for (const auto& path : files_of(robot, pattern, diagnostics_)) {
        const auto text = text_of(path.string());
        auto given = text ? model::read_transition(*text, path.string(), diagnostics_) : std::nullopt;
        if (given) transitions.push_back(std::move(*given));
      }
    }
    model::check_names(transitions, diagnostics_);
    return transitions;
  }

  /// Without networks (nullptr), what missions ask of them is not checked.
  void check_missions(const model::Robot& robot, const std::vector<model::Network>* networks) {
    for (const std::string& pattern : robot.missions) {
      for (const auto& path : files_of(robot, pattern, diagnostics_)) {
        ++files_;
        if (networks == nullptr) {
          missions_.check(path, diagnostics_);
        } else {
          const RobotControllers known{*networks, robot.pools, robot.units, catalog_};
          missions_.check(path, diagnostics_, &known);
        }
      }
    }
  }

  /// Where something could not be read, that a host or controller is missing may follow from it.
  void check_robot(const model::Robot& robot, const std::vector<model::Network>& networks, bool complete) {
    Diagnostics found = model::validate(robot, networks);
    const auto depth = options_.structure ? Depth::Structure : Depth::Full;
    found.append(model::validate(model::pool_network(robot.pools), catalog_, depth));
    if (!options_.structure) model::check_halt_members(robot, networks, catalog_, found);
    if (!robot.halt && !robot.missions.empty()) {
      found.warning(
          "no-halt",
          "the robot has missions, but its file does not say how it comes to rest: after a mission that is "
          "stopped or lost it runs on ('halt: {controller: NAME, at_rest: [...]}')",
          robot.where);
    }
    for (const Diagnostic& item : found.items()) {
      const bool may_follow = (item.code == "unknown-host" && robot.hosts.empty()) ||
                              item.code == "unknown-controller" || item.code == "unknown-task" ||
                              item.code == "no-fallback";
      if (complete || !may_follow) diagnostics_.add(item);
    }
  }

  static bool is_rafcon_machine(const std::filesystem::path& folder) {
    std::error_code ignored;
    return std::filesystem::exists(folder / "statemachine.json", ignored);
  }

  /// Journals are databases, so they are not read as text.
  static bool is_journal(const std::filesystem::path& file) {
    constexpr std::string_view kMagic = "SQLite format 3";
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) return false;
    std::string begin(kMagic.size(), '\0');
    std::ifstream stream(file, std::ios::binary);
    return stream.read(begin.data(), static_cast<std::streamsize>(begin.size())) && begin == kMagic;
  }

  void check_journal(const std::string& file) {
    auto reader = journal::JournalReader::open(file);
    const Result<void> sound = reader ? reader->check() : Result<void>(reader.error());
    if (!sound) diagnostics_.error("bad-journal", sound.error().message, {file, 0, 0});
  }

  /// A plan can be checked only with its domain and its problem.
  void check_pddl() {
    std::array<std::vector<pddl::PddlText>, 3> parts;
    const std::size_t errors_before = diagnostics_.error_count();
    for (const auto& [file, text] : pddl_) {
      const auto part = pddl::part_of({text, file}, diagnostics_);
      if (part) parts.at(static_cast<std::size_t>(*part)).push_back({text, file});
    }
    if (pddl_.empty() || diagnostics_.error_count() > errors_before) return;
    if (std::ranges::all_of(parts, [](const auto& texts) { return texts.size() == 1; })) {
      (void)pddl::read_pddl(parts[0][0], parts[1][0], parts[2][0], diagnostics_);
    } else {
      diagnostics_.error("incomplete-pddl",
                         "a PDDL plan is checked with its domain and its problem; name one file of each",
                         {pddl_.front().first, 0, 0});
    }
  }

  void check(const Parts& parts, Depth depth) {
    Diagnostics found = parts.complete ? model::validate(parts.network, catalog_, depth)
                                       : model::validate_references(parts.network, catalog_, depth);
    if (parts.complete && depth == Depth::Full) check_ros2_ports(parts.network, found);
    diagnostics_.append(found);
    if (!parts.complete || found.has_errors()) return;
    const Diagnostics advice = model::hints(parts.network, catalog_);
    if (options_.hints) {
      diagnostics_.append(advice);
    } else {
      hidden_hints_ += advice.items().size();
    }
  }

  /// If no component is known, reporting each of them would not help.
  Depth depth_for(const model::Network& network) {
    const bool known = network.tasks.empty() ||
                       std::any_of(network.tasks.begin(), network.tasks.end(), [&](const model::Task& task) {
                         return catalog_.find(task.component) != nullptr;
                       });
    if (known) return Depth::Full;
    shallow_.push_back(network.file);
    return Depth::Structure;
  }

  const CheckOptions& options_;
  Diagnostics diagnostics_;
  CheckedMissions missions_;
  model::ComponentCatalog catalog_;
  std::vector<Parts> networks_;
  std::vector<std::pair<std::string, std::string>> pddl_;  ///< names and texts
  std::vector<std::string> shallow_;
  std::size_t files_ = 0;
  std::size_t hidden_hints_ = 0;
};

void print_summary(const Checker& checker, bool hints_wanted) {
  const auto found = [&](Severity severity, std::string_view what) {
    const auto count = std::ranges::count(checker.diagnostics().items(), severity, &Diagnostic::severity);
    return counted(static_cast<std::size_t>(count), what);
  };
  const bool problems = std::ranges::any_of(
      checker.diagnostics().items(), [](const Diagnostic& item) { return item.severity != Severity::Hint; });
  std::string summary = problems
                            ? found(Severity::Error, "error") + ", " + found(Severity::Warning, "warning")
                            : coloured(Colour::Green, "no problems");
  if (hints_wanted) summary += ", " + found(Severity::Hint, "hint");
  if (checker.hidden_hints() > 0)
    summary += ", " + counted(checker.hidden_hints(), "hint") + " (see --hints)";
  print_line(fmt::format("{}: {}", counted(checker.files(), "file"), summary));
}

int check_files(const CheckOptions& options, const Context& context) {
  Checker checker(options);
  checker.run();
  print_diagnostics(checker.diagnostics());
  for (const std::string& file : checker.shallow()) {
    print_note(
        fmt::format("{}: none of its components is known, so only its structure was checked; name their "
                    "models with --models or --robot-file",
                    file));
  }
  if (context.json()) {
    print_json(checker.missions().to_value(checker.diagnostics()));
  } else {
    checker.missions().print();
    print_summary(checker, options.hints);
  }
  return checker.diagnostics().has_errors() ? kFailed : kDone;
}

}  // namespace

void add_check(Verb& app, Context& context) {
  const auto options = std::make_shared<CheckOptions>();
  Verb& verb = add_verb(app, context, "check", "validate every kind of file that other verbs read",
                        "  segue check robot.yaml\n  segue check --models 'models/*.yml' controllers/*.cnd\n"
                        "  segue check domain.pddl problem.pddl plan",
                        [options, &context] { return check_files(*options, context); });
  verb.option("FILE", options->files,
              "networks, robots (with all files that they name), missions, RAFCON folders, task networks, "
              "transitions, component models, .tlb files, stand-ins, PDDL, mappings of plans, journals")
      .required();
  verb.flag("--structure", options->structure,
            "check names and references only, not components, ports and types");
  verb.flag("--hints", options->hints,
            "also advice on networks that will run, but probably not as meant or not as well as they could");
  verb.option("--libraries DIR", options->libraries,
              "where missions find their state machines; for RAFCON NAME=DIR");
  add_model_options(verb, options->sources);
}

}  // namespace segue::cli
