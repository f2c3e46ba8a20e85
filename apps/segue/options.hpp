// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

/// The verbs of a command line and their options. options.cpp alone knows the library that parses them, which
/// is slow to compile.
namespace segue::cli {

/// A handle to one option of a verb; valid as long as the verb. The names of the options appear in the
/// messages of a failed parse.
class Option {
 public:
  struct Impl;
  explicit Option(Impl& impl) : impl_(&impl) {}

  Option required() const;
  Option needs(Option other) const;
  Option excludes(Option other) const;
  /// The number of values that follow its name.
  Option takes(int values) const;
  /// One value after each occurrence, so that a list does not swallow the positional arguments that follow.
  Option takes_one_at_a_time() const;

  Option one_of(const std::vector<std::string>& choices) const;
  Option between(std::size_t lowest, std::size_t highest) const;
  /// Limits an option whose value is a duration.
  Option between(Duration lowest, Duration highest) const;
  /// `problem` returns what is wrong with a value, or nothing.
  Option check(std::function<std::string(const std::string&)> problem) const;

  /// Whether the command line has the option; after the parse.
  [[nodiscard]] bool given() const;

 private:
  Impl* impl_;
};

/// A verb, with verbs of its own or options. The program itself is the outermost one.
class Verb {
 public:
  struct Impl;
  explicit Verb(std::unique_ptr<Impl> impl);
  Verb(const std::string& name, const std::string& description);
  ~Verb();
  Verb(const Verb&) = delete;
  Verb& operator=(const Verb&) = delete;

  Verb& add_verb(const std::string& name, const std::string& description);
  /// Not listed in help and completion.
  Verb& hide();
  void footer(const std::string& text);
  void version(const std::string& text);
  void require_verb();
  /// `given` runs at the end of a successful parse in which this verb is the one that was named.
  void on_given(std::function<void()> given);

  /// An option ("-o,--output FILE": its names, and after a blank what help calls its value) or a positional
  /// argument
  /// ("FILE"). The target keeps its value where the command line does not have the option, and must outlive
  /// the parse.
  Option option(const std::string& names, std::string& target, const std::string& help);
  Option option(const std::string& names, std::vector<std::string>& target, const std::string& help);
  Option option(const std::string& names, std::uint32_t& target, const std::string& help);
  Option option(const std::string& names, std::uint64_t& target, const std::string& help);
  /// "500ms" or "3 s"; not negative.
  Option option(const std::string& names, Duration& target, const std::string& help);
  /// `parse` takes the text of the value; the message of its error is shown.
  Option option(const std::string& names, std::function<Result<void>(const std::string&)> parse,
                const std::string& help);
  /// True where the command line has it; of "--wait,!--no-wait" the second name means false.
  Option flag(const std::string& names, bool& target, const std::string& help);
  /// At least one of them must be given; `what` names them in the message.
  void require_any(std::vector<Option> options, std::string what);

  /// Parses the command line of a program. False: help or the version was asked for and has been printed.
  /// InvalidArgument: the command line is wrong.
  Result<bool> parse(int count, char** arguments);

  [[nodiscard]] std::string name() const;
  /// The name with the verbs around it: "segue mission run".
  [[nodiscard]] std::string full_name() const;
  [[nodiscard]] std::string description() const;
  /// The verbs that are not hidden, in the order in which they were added.
  [[nodiscard]] std::vector<const Verb*> verbs() const;
  /// Null where it has no such verb.
  [[nodiscard]] const Verb* find(const std::string& name) const;
  /// "-o", "--output", ...; in the order in which they were added, with those of help.
  [[nodiscard]] std::vector<std::string> option_names() const;
  /// Whether words that are neither verbs nor options may follow it.
  [[nodiscard]] bool takes_arguments() const;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace segue::cli
