// SPDX-License-Identifier: Apache-2.0
#include "options.hpp"

#include <segue/base/text.hpp>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <deque>
#include <limits>
#include <utility>

namespace segue::cli {

struct Option::Impl {
  CLI::Option* option;
};

struct Verb::Impl {
  CLI::App* app;
  const Verb* parent = nullptr;
  std::unique_ptr<CLI::App> program = nullptr;  ///< of the outermost verb, which owns all the others'
  std::deque<Verb> verbs = {};                  // deques: references to elements stay valid
  std::deque<Option::Impl> options = {};

  Option keep(CLI::Option* option) { return Option(options.emplace_back(Option::Impl{option})); }

  template <class Target>
  Option add(const std::string& names, Target& target, const std::string& help);
};

namespace {

constexpr int kHelpColumn = 34;

/// "-o,--output FILE" in two: the names, and what the value is called.
std::pair<std::string, std::string> split_names(const std::string& names) {
  const auto blank = names.find(' ');
  if (blank == std::string::npos) return {names, ""};
  return {names.substr(0, blank), names.substr(blank + 1)};
}

/// A validator without a text of its own in help.
template <class Validator>
Validator silent(Validator validator) {
  validator.description("");
  return validator;
}

/// The parser's own conversion takes negative numbers and those that are too large for others.
template <class Number>
std::string problem_of_number(const std::string& text) {
  Number number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error == std::errc() && stop == end) return {};
  return "must be an integer from 0 to " + std::to_string(std::numeric_limits<Number>::max()) + ", got " +
         quote(text);
}

constexpr Duration kLongest = std::chrono::hours(24 * 366);  // clocks must not overflow

Result<Duration> parse_length(const std::string& text) {
  auto duration = parse_duration(text);
  if (duration && *duration < Duration(0))
    return fail(ErrorCode::InvalidArgument, "a duration cannot be negative");
  if (duration && *duration > kLongest)
    return fail(ErrorCode::InvalidArgument, "a duration cannot be longer than a year");
  return duration;
}

}  // namespace

Option Option::required() const {
  impl_->option->required();
  return *this;
}

Option Option::needs(Option other) const {
  impl_->option->needs(other.impl_->option);
  return *this;
}

Option Option::excludes(Option other) const {
  impl_->option->excludes(other.impl_->option);
  return *this;
}

Option Option::takes(int values) const {
  impl_->option->expected(values);
  return *this;
}

Option Option::takes_one_at_a_time() const {
  impl_->option->allow_extra_args(false);
  return *this;
}

Option Option::one_of(const std::vector<std::string>& choices) const {
  impl_->option->check(silent(CLI::IsMember(choices)));
  return *this;
}

Option Option::between(std::size_t lowest, std::size_t highest) const {
  impl_->option->check(silent(CLI::Range(lowest, highest)));
  return *this;
}

Option Option::between(Duration lowest, Duration highest) const {
  return check([lowest, highest](const std::string& text) -> std::string {
    const auto length = parse_length(text);
    if (!length || (*length >= lowest && *length <= highest))
      return {};  // what cannot be read is told elsewhere
    return "must be from " + format_duration(lowest) + " to " + format_duration(highest) + ", got " + text;
  });
}

Option Option::check(std::function<std::string(const std::string&)> problem) const {
  impl_->option->check(CLI::Validator(std::move(problem), ""));
  return *this;
}

bool Option::given() const {
  return impl_->option->count() > 0;
}

template <class Target>
Option Verb::Impl::add(const std::string& names, Target& target, const std::string& help) {
  const auto [words, value] = split_names(names);
  return keep(app->add_option(words, target, help)->type_name(value));
}

Verb::Verb(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Verb::Verb(const std::string& name, const std::string& description) {
  auto program = std::make_unique<CLI::App>(description, name);
  program->get_formatter()->column_width(kHelpColumn);
  CLI::App* app = program.get();
  impl_ = std::make_unique<Impl>(Impl{.app = app, .program = std::move(program)});
}

Verb::~Verb() = default;

Verb& Verb::add_verb(const std::string& name, const std::string& description) {
  CLI::App* app = impl_->app->add_subcommand(name, description);
  return impl_->verbs.emplace_back(std::make_unique<Impl>(Impl{.app = app, .parent = this}));
}

Verb& Verb::hide() {
  impl_->app->group("");
  return *this;
}

void Verb::footer(const std::string& text) {
  impl_->app->footer(text);
}

void Verb::version(const std::string& text) {
  impl_->app->set_version_flag("--version", text);
}

void Verb::require_verb() {
  impl_->app->require_subcommand(1);
}

void Verb::on_given(std::function<void()> given) {
  // CLI11 calls back for the verbs around the one that was named, too.
  impl_->app->callback([app = impl_->app, given = std::move(given)] {
    if (app->get_subcommands().empty()) given();
  });
}

Option Verb::option(const std::string& names, std::string& target, const std::string& help) {
  return impl_->add(names, target, help);
}

Option Verb::option(const std::string& names, std::vector<std::string>& target, const std::string& help) {
  return impl_->add(names, target, help);
}

Option Verb::option(const std::string& names, std::uint32_t& target, const std::string& help) {
  return impl_->add(names, target, help).check(problem_of_number<std::uint32_t>);
}

Option Verb::option(const std::string& names, std::uint64_t& target, const std::string& help) {
  return impl_->add(names, target, help).check(problem_of_number<std::uint64_t>);
}

Option Verb::option(const std::string& names, Duration& target, const std::string& help) {
  const auto parse = [&target](const std::string& text) -> Result<void> {
    const auto length = parse_length(text);
    if (!length) return tl::unexpected(length.error());
    target = *length;
    return {};
  };
  return option(names, parse, help);
}

Option Verb::option(const std::string& names, std::function<Result<void>(const std::string&)> parse,
                    const std::string& help) {
  const auto [words, value] = split_names(names);
  const auto parse_or_throw = [parse = std::move(parse), words = words](const std::string& text) {
    if (auto parsed = parse(text); !parsed) throw CLI::ValidationError(words, parsed.error().message);
  };
  return impl_->keep(
      impl_->app->add_option_function<std::string>(words, parse_or_throw, help)->type_name(value));
}

Option Verb::flag(const std::string& names, bool& target, const std::string& help) {
  return impl_->keep(impl_->app->add_flag(names, target, help));
}

void Verb::require_any(std::vector<Option> options, std::string what) {
  impl_->app->parse_complete_callback([options = std::move(options), what = std::move(what)] {
    if (std::ranges::none_of(options, &Option::given)) throw CLI::RequiredError(what);
  });
}

Result<bool> Verb::parse(int count, char** arguments) {
  try {
    impl_->app->parse(count, arguments);
    return true;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return fail(ErrorCode::InvalidArgument, error.what());
    impl_->app->exit(error);
    return false;
  }
}

std::string Verb::name() const {
  return impl_->app->get_name();
}

std::string Verb::full_name() const {
  return impl_->parent == nullptr ? name() : impl_->parent->full_name() + ' ' + name();
}

std::string Verb::description() const {
  return impl_->app->get_description();
}

std::vector<const Verb*> Verb::verbs() const {
  std::vector<const Verb*> found;
  for (const Verb& verb : impl_->verbs) {
    if (!verb.impl_->app->get_group().empty()) found.push_back(&verb);
  }
  return found;
}

const Verb* Verb::find(const std::string& name) const {
  const auto found = std::ranges::find(impl_->verbs, name, &Verb::name);
  return found == impl_->verbs.end() ? nullptr : &*found;
}

std::vector<std::string> Verb::option_names() const {
  std::vector<std::string> names;
  const CLI::App& app = *impl_->app;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_snames())
      names.push_back('-' + name);
    for (const std::string& name : option->get_lnames())
      names.push_back("--" + name);
  }
  return names;
}

bool Verb::takes_arguments() const {
  return std::ranges::any_of(std::as_const(*impl_->app).get_options(),
                             [](const CLI::Option* option) { return option->get_positional(); });
}

}  // namespace segue::cli
