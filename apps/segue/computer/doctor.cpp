// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <algorithm>

#include "../output.hpp"
#include "doctor_checks.hpp"

namespace segue::cli {

namespace {

using type::Value;

Value to_value(const Finding& finding) {
  return Value::map({{"check", finding.check},
                     {"health", kHealthNames.at(static_cast<std::size_t>(finding.health))},
                     {"what", finding.what},
                     {"mend", finding.mend.empty() ? Value() : Value(finding.mend)}});
}

std::string text_of(const Finding& finding) {
  constexpr std::array kColours = {Colour::Green, Colour::Yellow, Colour::Red};
  const auto health = static_cast<std::size_t>(finding.health);
  std::string text = fmt::format("{}  {}: {}\n",
                                 coloured(kColours.at(health), fmt::format("{:<6}", kHealthNames.at(health))),
                                 finding.check, finding.what);
  if (!finding.mend.empty()) text += fmt::format("        mend it: {}\n", finding.mend);
  return text;
}

int examine(const Context& context) {
  const auto findings = examine_computer();
  const bool is_bad =
      std::ranges::any_of(findings, [](const Finding& one) { return one.health == Health::Bad; });
  if (context.json()) {
    Value::List list;
    for (const Finding& finding : findings)
      list.push_back(to_value(finding));
    print_json(Value(std::move(list)));
  } else {
    for (const Finding& finding : findings)
      print(text_of(finding));
  }
  return is_bad ? kFailed : kDone;
}

}  // namespace

void add_doctor(Verb& app, Context& context) {
  add_verb(app, context, "doctor", "look whether robots can run on this computer, and what mends it",
           "  segue doctor\n\nStatus 1 where something does not work; advice does not count.",
           [&context] { return examine(context); });
}

}  // namespace segue::cli
